// What can be done to a plan, which is CHOrD JSON in centimetres, y up. Nothing here draws.

const WALL_CM = 24;
/** Faces of one wall lie at most so far apart. */
const ACROSS_CM = 45;
const SNAP_CM = 6;
const SIZES = {
  door: { length: 90, height: 210, z: 0 },
  window: { length: 120, height: 120, z: 90 },
  passage: { length: 100, height: 220, z: 0 },
};

export const ROOM_KINDS = [
  "living", "dining", "kitchen", "bedroom", "bathroom", "washroom", "wc", "study", "corridor",
  "balcony", "store", "unknown",
];
export const OPENING_KINDS = Object.keys(SIZES);

export const roomsOf = (plan) => plan.rooms.filter((room) => room.roomType !== 0);
export const kindOf = (room) => room.roomKind;

export const copy = (plan) => structuredClone(plan);

const sub = (a, b) => [a[0] - b[0], a[1] - b[1]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1];
const length = (a) => Math.hypot(a[0], a[1]);

/** A wall's face: its ends, the way along it and the way out of its room. */
export function edgeOf(room, index) {
  const points = room.wallPoints;
  const from = points[index];
  const to = points[(index + 1) % points.length];
  const span = length(sub(to, from));
  const along = sub(to, from).map((x) => x / (span || 1));
  return { from, to, along, out: [along[1], -along[0]], span };
}

/** All faces of the wall that a face belongs to, found from face to face: {room, index, side}. */
export function wallOf(plan, room, index) {
  const found = [];
  const start = edgeOf(room, index);
  const waiting = [{ room, index }];
  const has = (one) => found.some((f) => f.room === one.room && f.index === one.index);
  while (waiting.length) {
    const one = waiting.pop();
    if (has(one)) continue;
    found.push(one);
    const own = edgeOf(one.room, one.index);
    for (const other of roomsOf(plan)) {
      other.wallPoints.forEach((_, at) => {
        if (facing(own, edgeOf(other, at))) waiting.push({ room: other, index: at });
      });
    }
  }
  return { faces: found, along: start.along, out: start.out };
}

/** Whether two faces look away from each other across one wall. */
function facing(a, b) {
  if (dot(a.along, b.along) > -0.999) return false;
  const across = dot(sub(b.from, a.from), a.out);
  if (across < -1 || across > ACROSS_CM) return false;
  const [low, high] = [dot(sub(b.to, a.from), a.along), dot(sub(b.from, a.from), a.along)];
  return Math.min(high, a.span) - Math.max(low, 0) > 1;
}

/** Openings in a wall. */
function openingsIn(plan, wall) {
  return plan.windowsDoors.filter((opening) =>
    wall.faces.some(({ room, index }) => {
      const edge = edgeOf(room, index);
      const to = sub(opening.pos, edge.from);
      const across = dot(to, edge.out);
      const at = dot(to, edge.along);
      return across > -5 && across < ACROSS_CM && at > 0 && at < edge.span;
    }),
  );
}

/** Move a wall, with both its faces and what is in it, across itself. by: [x, y] in cm. */
export function moveWall(plan, room, index, by) {
  const wall = wallOf(plan, room, index);
  const far = Math.round(dot(by, wall.out));
  const shift = wall.out.map((x) => x * far);
  const openings = openingsIn(plan, wall);
  const moved = new Set();
  for (const face of wall.faces) {
    const points = face.room.wallPoints;
    moved.add(points[face.index]).add(points[(face.index + 1) % points.length]);
  }
  for (const point of moved) {
    point[0] += shift[0];
    point[1] += shift[1];
  }
  for (const opening of openings) {
    opening.pos[0] += shift[0];
    opening.pos[1] += shift[1];
  }
}

/** Make a face so many cm long, by moving the wall at its end. */
export function setLength(plan, room, index, cm) {
  const { along, span } = edgeOf(room, index);
  const by = along.map((x) => x * (cm - span));
  moveWall(plan, room, (index + 1) % room.wallPoints.length, by);
}

/** Move a corner to a place, in line with its neighbours where it nearly is. */
export function moveCorner(room, index, place) {
  const points = room.wallPoints;
  const beside = [points.at(index - 1), points[(index + 1) % points.length]];
  const snapped = [0, 1].map((axis) => {
    const near = beside.find((point) => Math.abs(point[axis] - place[axis]) < SNAP_CM);
    return near ? near[axis] : Math.round(place[axis]);
  });
  points[index].splice(0, 2, ...snapped);
}

/** Put a corner in the middle of a face, so that the wall can have a step or a slant. */
export function addCorner(room, index) {
  const { from, to } = edgeOf(room, index);
  room.wallPoints.splice(index + 1, 0, [(from[0] + to[0]) / 2, (from[1] + to[1]) / 2]);
}

export function removeCorner(room, index) {
  if (room.wallPoints.length > 3) room.wallPoints.splice(index, 1);
}

/** Slide an opening along its wall to a place. */
export function moveOpening(opening, place) {
  const angle = (opening.rotate * Math.PI) / 180;
  const along = [Math.cos(angle), Math.sin(angle)];
  const far = Math.round(dot(sub(place, opening.pos), along));
  opening.pos[0] += along[0] * far;
  opening.pos[1] += along[1] * far;
  delete opening.roomIds; // whoever reads the plan finds the rooms beside it
}

export function setOpeningKind(opening, kind) {
  const size = SIZES[kind];
  opening.type = kind;
  opening.height = size.height;
  opening.pos[2] = size.z;
}

/** A new opening in the wall of a face, at the place on it nearest to a point; returns it. */
export function addOpening(plan, room, index, place, kind) {
  const edge = edgeOf(room, index);
  const wall = wallOf(plan, room, index);
  const across = wall.faces
    .map((face) => dot(sub(edgeOf(face.room, face.index).from, edge.from), edge.out))
    .filter((far) => far > 1);
  const thick = across.length ? Math.min(...across) : WALL_CM;
  const size = SIZES[kind];
  const span = Math.min(size.length, edge.span - 2);
  const at = Math.min(Math.max(dot(sub(place, edge.from), edge.along), span / 2), edge.span - span / 2);
  const [x, y] = [0, 1].map(
    (axis) => edge.from[axis] + edge.along[axis] * at + (edge.out[axis] * thick) / 2,
  );
  const opening = {
    type: kind,
    pos: [x, y, size.z],
    length: span,
    width: thick,
    height: size.height,
    rotate: Math.round((Math.atan2(edge.along[1], edge.along[0]) * 180) / Math.PI),
    id: freeName(plan.windowsDoors.map((one) => one.id), kind),
  };
  plan.windowsDoors.push(opening);
  return opening;
}

function freeName(taken, stem) {
  let number = 1;
  while (taken.includes(`${stem}${number}`)) number += 1;
  return `${stem}${number}`;
}

/** Cut a room in two by a wall across the middle of a face; returns the new room, or null. */
export function splitRoom(plan, room, index, place) {
  const edge = edgeOf(room, index);
  const at = dot(sub(place, edge.from), edge.along);
  const half = WALL_CM / 2;
  const parts = [-1, 1].map((side) => clipped(room.wallPoints, edge, at + side * half, side));
  if (parts.some((part) => part.length < 3)) return null;
  const made = {
    ...structuredClone(room),
    roomId: freeName(plan.rooms.map((one) => one.roomId), kindOf(room)),
    wallPoints: parts[1],
  };
  room.wallPoints = parts[0];
  plan.rooms.push(made);
  for (const opening of plan.windowsDoors) delete opening.roomIds;
  return made;
}

/** Make one room of two by taking away the wall between them, at a place on a face; returns whether
 * there is another room across it. */
export function joinRooms(plan, room, index, place) {
  const own = edgeOf(room, index);
  const at = dot(sub(place, own.from), own.along);
  const beyond = acrossFrom(plan, room, own, at);
  if (!beyond) return false;
  const other = edgeOf(beyond.room, beyond.index);
  const far = (point) => dot(sub(point, own.from), own.along);
  const [low, high] = [Math.max(0, far(other.to)), Math.min(own.span, far(other.from))];
  const onOwn = (x) => own.from.map((from, axis) => from + own.along[axis] * x);
  const onOther = (x) => other.to.map((to, axis) => to + own.along[axis] * (x - far(other.to)));
  const thick = dot(sub(other.from, own.from), own.out);
  plan.windowsDoors = plan.windowsDoors.filter(({ pos }) => {
    const across = dot(sub(pos, own.from), own.out);
    return far(pos) < low || far(pos) > high || across < -1 || across > thick + 1;
  });
  const around = (points, start) => points.map((_, k) => points[(start + k) % points.length]);
  room.wallPoints = withoutIdle([
    ...around(room.wallPoints, index + 1), onOwn(low),
    onOther(low), ...around(beyond.room.wallPoints, beyond.index + 1), onOther(high), onOwn(high),
  ]);
  plan.rooms = plan.rooms.filter((one) => one !== beyond.room);
  for (const opening of plan.windowsDoors) delete opening.roomIds;
  return true;
}

/** The face of another room across a wall, at so far along a face. */
function acrossFrom(plan, room, own, at) {
  for (const other of roomsOf(plan)) {
    if (other === room) continue;
    const index = other.wallPoints.findIndex((_, k) => {
      const edge = edgeOf(other, k);
      const [low, high] = [edge.to, edge.from].map((end) => dot(sub(end, own.from), own.along));
      return facing(own, edge) && low <= at && at <= high;
    });
    if (index >= 0) return { room: other, index };
  }
  return null;
}

/** A ring without corners that stand on the one before, or in line with both beside them. */
function withoutIdle(points) {
  const apart = points.filter((point, k) => length(sub(point, points.at(k - 1))) > 0.5);
  return apart.filter((point, k) => {
    const [before, after] = [apart.at(k - 1), apart[(k + 1) % apart.length]];
    const [a, b] = [sub(point, before), sub(after, point)];
    return Math.abs(a[0] * b[1] - a[1] * b[0]) > 0.01 * length(a) * length(b);
  });
}

/** The part of a polygon before (side -1) or beyond (1) a line across the way along an edge. */
function clipped(points, edge, at, side) {
  const far = (point) => (dot(sub(point, edge.from), edge.along) - at) * side;
  const kept = [];
  points.forEach((point, index) => {
    const next = points[(index + 1) % points.length];
    const [a, b] = [far(point), far(next)];
    if (a >= 0) kept.push([...point]);
    if (a * b < 0) {
      const share = a / (a - b);
      kept.push([0, 1].map((axis) => point[axis] + (next[axis] - point[axis]) * share));
    }
  });
  return kept;
}

/** Give a room another kind; a name that says something else stays. */
export function setKind(room, kind) {
  if (room.roomName === kindOf(room)) room.roomName = kind;
  room.roomKind = kind;
}

/** Make a room the kitchen; the room that was it gets the kind of this one. */
export function moveKitchen(plan, room) {
  const kind = kindOf(room);
  for (const other of roomsOf(plan)) if (kindOf(other) === "kitchen") setKind(other, kind);
  setKind(room, "kitchen");
}

/** Take a room away, and the openings that led to nothing else. */
export function removeRoom(plan, room) {
  plan.rooms = plan.rooms.filter((one) => one !== room);
  plan.windowsDoors = plan.windowsDoors.filter(
    (opening) => !(opening.roomIds?.length === 1 && opening.roomIds[0] === room.roomId),
  );
  for (const opening of plan.windowsDoors) delete opening.roomIds;
}

export function removeOpening(plan, opening) {
  plan.windowsDoors = plan.windowsDoors.filter((one) => one !== opening);
}

/** Make everything larger or smaller, but for heights; drawing: where the picture lies. */
export function rescale(plan, drawing, factor) {
  const round = (x) => Math.round(x * factor * 1e4) / 1e4;
  for (const room of plan.rooms) {
    for (const point of room.wallPoints) point.splice(0, 2, round(point[0]), round(point[1]));
  }
  for (const opening of plan.windowsDoors) {
    opening.pos.splice(0, 2, round(opening.pos[0]), round(opening.pos[1]));
    opening.length = round(opening.length);
    opening.width = round(opening.width);
  }
  if (plan.drawing) {
    plan.drawing.mPerPx *= factor;
    plan.drawing.originM = plan.drawing.originM.map((x) => x * factor);
  }
  if (drawing) {
    drawing.m_per_px *= factor;
    drawing.origin_m = drawing.origin_m.map((x) => x * factor);
  }
}

export function areaM2(room) {
  const points = room.wallPoints;
  const twice = points.reduce((sum, [x, y], index) => {
    const [nextX, nextY] = points[(index + 1) % points.length];
    return sum + x * nextY - nextX * y;
  }, 0);
  return Math.abs(twice) / 2e4;
}

/** A place within a room for its name: of some, that which is farthest from its walls. */
export function middleOf(room) {
  const points = room.wallPoints;
  const [xs, ys] = [0, 1].map((axis) => points.map((point) => point[axis]));
  const [left, right, low, high] = [Math.min(...xs), Math.max(...xs), Math.min(...ys), Math.max(...ys)];
  let best = [points[0], -1];
  for (let i = 1; i < 12; i += 1) {
    for (let j = 1; j < 12; j += 1) {
      const place = [left + ((right - left) * i) / 12, low + ((high - low) * j) / 12];
      const far = isInside(points, place) ? Math.min(...points.map((_, k) => distance(points, k, place))) : -1;
      if (far > best[1]) best = [place, far];
    }
  }
  return best[0];
}

export function isInside(points, [x, y]) {
  let inside = false;
  points.forEach(([ax, ay], index) => {
    const [bx, by] = points[(index + 1) % points.length];
    if (ay > y !== by > y && x < ((bx - ax) * (y - ay)) / (by - ay) + ax) inside = !inside;
  });
  return inside;
}

function distance(points, index, place) {
  const from = points[index];
  const way = sub(points[(index + 1) % points.length], from);
  const share = Math.min(Math.max(dot(sub(place, from), way) / (dot(way, way) || 1), 0), 1);
  return length(sub(place, [from[0] + way[0] * share, from[1] + way[1] * share]));
}

/** What a reading is unsure of: {text, ids}. */
export const doubtsOf = (reading) =>
  reading?.doubts ?? (reading?.warnings ?? []).map((text) => ({ text, ids: [] }));

/** Ids that the doubts of a reading are about, or of which it is not sure. */
export function doubtedIds(reading) {
  const ids = new Set(doubtsOf(reading).flatMap((doubt) => doubt.ids));
  for (const [id, sure] of Object.entries(reading?.confidence ?? {})) if (sure < 0.5) ids.add(id);
  return ids;
}

/** The rooms and openings that a doubt is about and that the plan has: {type, item}. */
export function placesOf(plan, { ids }) {
  return ids.flatMap((id) => {
    const room = roomsOf(plan).find((one) => one.roomId === id);
    const item = room ?? plan.windowsDoors.find((one) => one.id === id);
    return item ? [{ type: room ? "room" : "opening", item }] : [];
  });
}
