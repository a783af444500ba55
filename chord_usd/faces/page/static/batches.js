// A GLB of a house as few draw calls: one batch for each material, whatever stands where.
//
// A dressed house has over a thousand meshes; a phone draws some hundreds well. three.js draws a
// BatchedMesh in one call, and still lets each of its parts be moved, hidden and clicked.
import { THREE } from "./three.js";

/** Groups of a room whose children are pieces. */
const GROUPS = ["Furniture", "Dressing", "Items"];

/**
 * Read the tree of a GLB. Returns {batches, pieces, rooms, cameras, box}: pieces by path, each
 * {path, name, category, room, node, parts, id, restsOn, group}, parts being {batch, id, mesh};
 * what belongs to no piece (walls, floors, ceilings) is a piece of group "Architecture".
 */
export function batched(scene) {
  scene.updateMatrixWorld(true);
  const pieces = new Map();
  const groups = new Map();
  const rooms = [];
  const cameras = [];
  const walk = (node, owner, place) => {
    if (node.isLight) return;
    if (node.isCamera) cameras.push(node.name);
    const { path, kind } = node.userData;
    const storey = /^Storey_(\d+)$/.exec(nameOf(node));
    if (storey) place = { ...place, storey: Number(storey[1]) };
    if (kind && path) {
      const { room, title = "", requests = "" } = node.userData;
      rooms.push({ name: room, kind, path, node, title, requests });
      place = { ...place, room: node.userData.room, path };
    }
    // What has no name of its own is the storey's, and is hidden with it.
    const mine = pieceOf(node, storey ? null : owner, place);
    if (mine && mine !== owner) mine.storey = place.storey;
    if (mine && mine !== owner) pieces.set(mine.path, mine);
    if (node.isMesh && mine) sort(groups, node, mine);
    for (const child of node.children) walk(child, mine ?? owner, place);
  };
  walk(scene, null, { room: "", path: "", storey: 0 });
  const batches = [...groups.values()].map(batchOf);
  const box = new THREE.Box3();
  for (const batch of batches) box.union(batch.geometryBox);
  return { batches, pieces, rooms, cameras, box };
}

/** The piece that a node begins, or that it is part of. */
function pieceOf(node, owner, { room, path: within }) {
  const group = node.parent ? nameOf(node.parent) : "";
  if (GROUPS.includes(group) && room) {
    const above = owner?.group === "Items" || owner?.group === "Furniture" ? owner.path : within;
    // What carries things is a group, with the model itself beside them.
    const model = node.userData.path ? node : node.children.find((one) => one.userData.path) ?? node;
    const said = model.userData;
    return {
      model,
      modelPath: said.path ?? `${above}/${group}/${nameOf(node)}`,
      path: `${above}/${group}/${nameOf(node)}`,
      name: nameOf(node),
      category: said.category ?? "",
      id: said.id ?? "",
      restsOn: said.rests_on ?? "",
      above: group === "Items" ? owner : null,
      room, node, group, parts: [],
    };
  }
  if (owner && GROUPS.includes(owner.group)) return owner;
  const { path, category } = node.userData;
  if (path && category) {
    return { path, name: nameOf(node), category, id: "", restsOn: "", above: null, room, node, group: "Architecture", parts: [] };
  }
  return owner ?? { path: node.uuid, name: nameOf(node), category: "", id: "", restsOn: "", above: null, room, node, group: "Architecture", parts: [] };
}

/** The name as the file has it: three.js gives doubles another one. */
const nameOf = (node) => node.userData.name ?? node.name;

function sort(groups, mesh, piece) {
  const { geometry, material } = mesh;
  const key = `${material.uuid} ${Object.keys(geometry.attributes).sort().join()}`;
  if (!groups.has(key)) groups.set(key, { material, parts: [] });
  groups.get(key).parts.push({ mesh, piece });
}

function batchOf({ material, parts }) {
  const geometries = new Set(parts.map(({ mesh }) => mesh.geometry));
  let [vertices, indices] = [0, 0];
  for (const geometry of geometries) {
    vertices += geometry.attributes.position.count;
    indices += geometry.index.count;
  }
  const batch = new THREE.BatchedMesh(parts.length, vertices, indices, material);
  const known = new Map();
  batch.geometryBox = new THREE.Box3();
  batch.owners = [];
  for (const { mesh, piece } of parts) {
    if (!known.has(mesh.geometry)) known.set(mesh.geometry, batch.addGeometry(mesh.geometry));
    const id = batch.addInstance(known.get(mesh.geometry));
    batch.setMatrixAt(id, mesh.matrixWorld);
    batch.owners[id] = piece;
    piece.parts.push({ batch, id, mesh });
    mesh.geometry.computeBoundingBox();
    // A roof is not seen at first: what one looks at is the house below it.
    if (piece.category !== "roof") batch.geometryBox.union(mesh.geometry.boundingBox.clone().applyMatrix4(mesh.matrixWorld));
  }
  // The batch has copies; of the originals only bounds are asked for later.
  for (const geometry of geometries) geometry.dispose();
  batch.frustumCulled = false; // its parts are, one by one
  return batch;
}

/**
 * Show a model, the node of a GLB, in the place of a piece's own; null: its own again. Returns the
 * batches that are new.
 */
export function wear(pieces, piece, model) {
  piece.ownParts ??= piece.parts;
  for (const { batch, id } of piece.parts) batch.setVisibleAt(id, false);
  let made = [];
  if (model && !model.userData.parts) {
    const groups = new Map();
    const worn = { ...piece, parts: [] };
    model.traverse((node) => node.isMesh && sort(groups, node, worn));
    piece.model.add(model);
    made = [...groups.values()].map(batchOf);
    for (const batch of made) batch.owners = batch.owners.map(() => piece);
    model.userData.parts = worn.parts;
  }
  piece.parts = model ? model.userData.parts : piece.ownParts;
  for (const { batch, id } of piece.parts) batch.setVisibleAt(id, true);
  place(pieces, piece);
  return made;
}

/** Put a piece's parts where its node is now, and those of all below it. */
export function place(pieces, piece) {
  piece.node.updateWorldMatrix(true, true);
  for (const one of pieces.values()) {
    if (one !== piece && !one.path.startsWith(`${piece.path}/`)) continue;
    for (const { batch, id, mesh } of one.parts) {
      batch.setMatrixAt(id, mesh.matrixWorld);
      batch.boundingSphere = batch.boundingBox = null;
    }
  }
}

/** Show or hide a piece and what stands on it. */
export function show(pieces, piece, isShown) {
  for (const one of pieces.values()) {
    if (one !== piece && !one.path.startsWith(`${piece.path}/`)) continue;
    for (const { batch, id } of one.parts) batch.setVisibleAt(id, isShown);
  }
}

/** The box round a piece, in the world, or in its own frame. */
export function boxOf(piece, isOwn = false) {
  const box = new THREE.Box3();
  const back = isOwn ? piece.node.matrixWorld.clone().invert() : null;
  for (const { mesh } of piece.parts) {
    const frame = back ? back.clone().multiply(mesh.matrixWorld) : mesh.matrixWorld;
    box.union(mesh.geometry.boundingBox.clone().applyMatrix4(frame));
  }
  return box;
}
