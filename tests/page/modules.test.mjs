// Modules of the page that draw nothing: what can be done to a plan, floors to walk on, work in turn.
import assert from "node:assert/strict";
import test from "node:test";
import { isOver, oneAtATime } from "./static/api.js";
import { openPlan } from "./static/outline.js";
import * as model from "./static/plan_model.js";
import { findingsOf } from "./static/planning.js";
import { floorsOf } from "./static/walker.js";

const box = (id, kind, x, y, wide, deep) => ({
  roomId: id, roomName: kind, roomType: 1, roomKind: kind,
  wallPoints: [[x, y], [x + wide, y], [x + wide, y + deep], [x, y + deep]],
});
const opening = (type, pos, rotate = 0) => ({ id: type, type, pos, length: 90, width: 24, height: 210, rotate });
const homes = [[300, 400], [250, 500], [700, 350]].map(([wide, deep]) => () => ({
  rooms: [box("a", "living", 0, 0, wide, deep), box("b", "bedroom", wide + 24, 0, wide, deep)],
  windowsDoors: [opening("door", [wide + 12, deep / 2, 0], 90), opening("window", [wide / 2, -12, 90])],
}));
const area = (plan) => model.roomsOf(plan).reduce((sum, room) => sum + model.areaM2(room), 0);
const inEach = (check) => () => homes.forEach((home) => check(home()));

test("a wall moves with both faces and its door, and back again", inEach((plan) => {
  const before = model.copy(plan);
  model.moveWall(plan, plan.rooms[0], 1, [40, 7]);
  assert.equal(plan.rooms[0].wallPoints[1][0], before.rooms[0].wallPoints[1][0] + 40);
  assert.equal(plan.rooms[1].wallPoints[0][0], before.rooms[1].wallPoints[0][0] + 40);
  assert.equal(plan.windowsDoors[0].pos[0], before.windowsDoors[0].pos[0] + 40);
  assert.deepEqual(plan.windowsDoors[1], before.windowsDoors[1]);
  assert.ok(Math.abs(area(plan) - area(before)) < 1e-9);
  model.moveWall(plan, plan.rooms[0], 1, [-40, 0]);
  assert.deepEqual(plan, before);
}));

test("a room that is split and joined is the room", inEach((plan) => {
  const before = model.copy(plan);
  const [room] = plan.rooms;
  const [wide] = room.wallPoints[1];
  const made = model.splitRoom(plan, room, 0, [wide * 0.4, 0]);
  assert.equal(new Set(plan.rooms.map((one) => one.roomId)).size, 3);
  assert.ok(Math.abs(area(plan) + (0.24 * room.wallPoints[2][1]) / 100 - area(before)) < 1e-6);
  const face = room.wallPoints.findIndex((_, k) => model.edgeOf(room, k).out[0] > 0.9);
  assert.ok(model.joinRooms(plan, room, face, room.wallPoints[face]));
  assert.ok(!plan.rooms.includes(made));
  assert.ok(Math.abs(area(plan) - area(before)) < 1e-6);
}));

test("a new opening lies in its wall, through all of it, under a free name", inEach((plan) => {
  for (const kind of model.OPENING_KINDS) {
    const made = model.addOpening(plan, plan.rooms[0], 1, [1e4, -1e4], kind);
    const [x] = plan.rooms[0].wallPoints[1];
    assert.deepEqual([made.pos[0], made.width, made.rotate], [x + 12, 24, 90]);
    assert.ok(made.pos[1] >= made.length / 2);
  }
  assert.equal(new Set(plan.windowsDoors.map((one) => one.id)).size, plan.windowsDoors.length);
}));

test("a scale keeps shapes: areas change by its square", inEach((plan) => {
  const before = area(plan);
  model.rescale(plan, null, 1.5);
  assert.ok(Math.abs(area(plan) / before - 2.25) < 1e-6);
}));

test("corners come in line with neighbours, never fewer than three", inEach((plan) => {
  const [room] = plan.rooms;
  model.moveCorner(room, 2, [room.wallPoints[1][0] + 4, 333.4]);
  assert.deepEqual(room.wallPoints[2], [room.wallPoints[1][0], 333]);
  model.addCorner(room, 0);
  for (let count = 0; count < 9; count += 1) model.removeCorner(room, 0);
  assert.equal(room.wallPoints.length, 3);
}));

test("the middle of a room is within it, in an L too", () => {
  const room = { wallPoints: [[0, 0], [600, 0], [600, 200], [200, 200], [200, 500], [0, 500]] };
  assert.ok(model.isInside(room.wallPoints, model.middleOf(room)));
  assert.ok(!model.isInside(room.wallPoints, [400, 400]));
});

test("doubts name ids; so does little confidence", () => {
  const doubts = [{ text: "room3 may be a study", ids: ["room3"] }];
  const reading = { doubts, confidence: { door1: 0.4, door2: 0.9 } };
  const told = model.doubtedIds(reading);
  assert.deepEqual(["room3", "door1", "door2"].map((id) => told.has(id)), [true, true, false]);
  assert.equal(model.doubtedIds(null).size, 0);
});

test("one walks in rooms and through doors, not through windows", inEach((plan) => {
  const floors = floorsOf(plan);
  const stands = (place) => floors.some((floor) => model.isInside(floor, place));
  const [door, window] = plan.windowsDoors.map(({ pos }) => [pos[0] / 100, pos[1] / 100]);
  assert.ok(stands(door) && !stands(window));
}));

test("an outline is one room", () => {
  const corners = [[0, 0], [500, 0], [500, 400], [0, 400]];
  assert.equal(area(openPlan(corners)), 20);
});

test("work is done in turn, also after work that failed", async () => {
  const seen = [];
  const turn = oneAtATime(async () => {
    seen.push("begin");
    await new Promise((done) => setTimeout(done, 1));
    seen.push("end");
    if (seen.length === 2) throw new Error("once");
  });
  await assert.rejects(Promise.all([turn(), turn()]));
  await turn();
  assert.deepEqual(seen, ["begin", "end", "begin", "end", "begin", "end"]);
  assert.deepEqual(["queued", "running", "done"].map((state) => isOver({ state })), [false, false, true]);
});

test("planning rules that are not kept name room, numbers and source, the worst room first", () => {
  const finding = (unit, rest) => ({ rule: "a rule", source: "HUD 1973", unit, items: [], at: [0, 0], ...rest });
  const living = { path: "/House/Rooms/LivingRoom_0", rules: 9, rules_kept: 8, findings: [finding("count", { have: 1, need: 0, items: ["/House/a"] })] };
  const bath = { path: "/House/Rooms/Bathroom_0", rules: 9, rules_kept: 6, findings: [
    finding("m", { have_m: 0.407, need_m: 1 }), finding("deg", { have: 30.2, need: 20 }), finding("share", { have: 0.25, need: 0.5 }),
  ] };
  const home = { path: "", rules: 4, rules_kept: 4, findings: [] };
  assert.deepEqual(findingsOf({ rooms: [living, bath], home }), [
    { text: "Bathroom_0, a rule: 41 cm, not 100 cm (HUD 1973)", paths: ["/House/Rooms/Bathroom_0"] },
    { text: "Bathroom_0, a rule: 30°, not 20° (HUD 1973)", paths: ["/House/Rooms/Bathroom_0"] },
    { text: "Bathroom_0, a rule: 25 %, not 50 % (HUD 1973)", paths: ["/House/Rooms/Bathroom_0"] },
    { text: "LivingRoom_0, a rule: 1, not 0 (HUD 1973)", paths: ["/House/a"] },
  ]);
  assert.deepEqual(findingsOf(undefined), []);
});
