// Where a piece stands, and what it runs into: boxes first, then what its surfaces fill.
import { boxOf } from "./batches.js";
import { isInside } from "./plan_model.js";
import { THREE } from "./three.js";

/** Surfaces are told apart by so much. */
const CELL_M = 0.03;
/** What touches does not collide, nor what goes so far into something: cushions give way. */
const SLACK_M = 0.025;
/** Whatever is lower can be stood upon. */
const FLAT_M = 0.03;

export class Collisions {
  /** house: as batched() has it; floors: polygons [[x, y]] in metres, of a piece; isGone: of a piece. */
  constructor(house, floors, isGone) {
    Object.assign(this, { house, floors, isGone, cells: new Map() });
  }

  /** Corners of the box that a piece fills on the floor, in the world: four, one after the other. */
  footprint(piece, slack = 0) {
    const { min, max } = boxOf(piece, true);
    return [[min.x + slack, min.y + slack], [max.x - slack, min.y + slack], [max.x - slack, max.y - slack], [min.x + slack, max.y - slack]]
      .map(([x, y]) => new THREE.Vector3(x, y, min.z).applyMatrix4(piece.node.matrixWorld));
  }

  /** What a piece runs into: categories of others, and "wall". */
  of(piece) {
    const found = new Set();
    if (piece.group === "Furniture" && !this.isOnFloor(piece)) found.add("wall");
    const box = boxOf(piece);
    if (box.max.y - box.min.y < FLAT_M) return found;
    for (const other of this.house.pieces.values()) {
      if (this.areApart(piece, other) || found.has(other.category)) continue;
      const its = boxOf(other).expandByScalar(-SLACK_M / 2);
      if (its.isEmpty() || !its.intersectsBox(box)) continue;
      if (this.meet(piece, other) || this.meet(other, piece)) found.add(other.category);
    }
    return found;
  }

  /** Whether two pieces have nothing to do with each other, or stand on one another. */
  areApart(piece, other) {
    if (other === piece || other.group === "Architecture" || !other.parts.length || this.isGone(other)) return true;
    if (other.above === piece || piece.above === other) return true;
    return Boolean((other.restsOn && other.restsOn === piece.id) || (piece.restsOn && piece.restsOn === other.id));
  }

  isOnFloor(piece) {
    const corners = this.footprint(piece, SLACK_M).map((corner) => [corner.x, -corner.z]);
    const middle = [0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis] / 4, 0));
    const floor = this.floors(piece).find((one) => isInside(one, middle));
    // Of a room with a corner that juts in, that corner must not be within the piece.
    return Boolean(floor) && corners.every((corner) => isInside(floor, corner)) && !floor.some((corner) => isInside(corners, corner));
  }

  /** Whether surfaces of one lie where surfaces of the other are, deeper than its skin. */
  meet(one, other) {
    const { cells, box } = this.filled(other);
    const own = this.filled(one);
    const frame = other.node.matrixWorld.clone().invert().multiply(one.node.matrixWorld);
    const [point, low, high] = [new THREE.Vector3(), box.min, box.max];
    for (const [x, y, z] of own.points) {
      point.set(x, y, z).applyMatrix4(frame);
      const isWithin = point.x > low.x + SLACK_M && point.x < high.x - SLACK_M && point.y > low.y + SLACK_M && point.y < high.y - SLACK_M;
      if (isWithin && cells.has(keyOf(point))) return true;
    }
    return false;
  }

  /** Cells that a piece's surfaces go through, in its own frame, found once. */
  filled(piece) {
    const known = this.cells.get(piece);
    if (known?.parts === piece.parts) return known;
    const made = { parts: piece.parts, cells: new Set(), points: [], box: boxOf(piece, true) };
    const back = piece.node.matrixWorld.clone().invert();
    for (const { mesh } of piece.parts) fill(made, mesh, back.clone().multiply(mesh.matrixWorld));
    this.cells.set(piece, made);
    return made;
  }
}

function keyOf({ x, y, z }) {
  return (Math.floor(x / CELL_M) + 512) * 1048576 + (Math.floor(y / CELL_M) + 512) * 1024 + Math.floor(z / CELL_M) + 512;
}

/** Note the cells of a mesh: points of each triangle, no farther apart than a cell. */
function fill({ cells, points }, mesh, frame) {
  const { position } = mesh.geometry.attributes;
  const { index } = mesh.geometry;
  const corners = [new THREE.Vector3(), new THREE.Vector3(), new THREE.Vector3()];
  const point = new THREE.Vector3();
  for (let at = 0; at < index.count; at += 3) {
    corners.forEach((corner, k) => corner.fromBufferAttribute(position, index.getX(at + k)).applyMatrix4(frame));
    const [a, b, c] = corners;
    const steps = Math.ceil(Math.max(a.distanceTo(b), b.distanceTo(c), c.distanceTo(a)) / CELL_M) || 1;
    for (let i = 0; i <= steps; i += 1) {
      for (let j = 0; j <= steps - i; j += 1) {
        const [u, v] = [i / steps, j / steps];
        point.set(0, 0, 0).addScaledVector(a, 1 - u - v).addScaledVector(b, u).addScaledVector(c, v);
        const key = keyOf(point);
        if (cells.has(key)) continue;
        cells.add(key);
        points.push([point.x, point.y, point.z]);
      }
    }
  }
}
