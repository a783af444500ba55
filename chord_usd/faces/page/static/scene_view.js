// The house on a canvas: light, camera, orbit and walk, what is clicked. Draws only when it must.
import { GLTFLoader, OrbitControls, THREE } from "./three.js";
import { batched, boxOf } from "./batches.js";
import { Walker } from "./walker.js";

const MOST_PIXELS = 2;
const EYE_M = 1.6;
/** From outside a narrow view looks like a model; within a room one wants to see some of it. */
const VIEW_DEG = 45;
const WALK_DEG = 70;
const [RIGHT, WRONG] = [0xd9661f, 0xe0101c];
const STILL_PX = 5;
/** Near the horizon a pixel is a hundred metres. */
const FARTHEST_M = 30;

export class SceneView {
  /**
   * picked: is told of the piece that was clicked, or null. held: asked whether a piece is to be
   * dragged, it returns {to, end}, which are told of metres in the plan and of the end.
   */
  constructor(canvas, { picked, held }) {
    Object.assign(this, { canvas, picked, held });
    this.renderer = new THREE.WebGLRenderer({ canvas, antialias: true, alpha: true, powerPreference: "low-power" });
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, MOST_PIXELS));
    this.renderer.toneMapping = THREE.NeutralToneMapping;
    this.renderer.localClippingEnabled = true;
    this.scene = new THREE.Scene();
    this.camera = new THREE.PerspectiveCamera(VIEW_DEG, 1, 0.05, 200);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.maxPolarAngle = Math.PI / 2 - 0.02;
    this.cut = new THREE.Plane(new THREE.Vector3(0, -1, 0), 100);
    this.light();
    this.listen();
  }

  light() {
    // The house's own lamps would cost each pixel as much as all else: sky and one sun do here.
    this.scene.add(new THREE.HemisphereLight(0xf4f7ff, 0x8a7f72, 1.1));
    const sun = new THREE.DirectionalLight(0xfff2e0, 1.7);
    sun.position.set(3, 8, 5);
    this.scene.add(sun);
    const sky = new THREE.Scene();
    sky.background = new THREE.Color(0xdde3e8);
    const maker = new THREE.PMREMGenerator(this.renderer);
    this.scene.environment = maker.fromScene(sky).texture;
    this.scene.environmentIntensity = 0.45;
    maker.dispose();
  }

  /** Show a GLB. Returns what batched() does. */
  async load(url) {
    const answer = await fetch(url);
    if (!answer.ok) throw new Error("The house cannot be loaded.");
    const { scene } = await new GLTFLoader().parseAsync(await answer.arrayBuffer(), "");
    if (this.isOver) return new Promise(() => {});
    this.house = batched(scene);
    this.add(this.house.batches.splice(0));
    this.overview();
    return this.house;
  }

  /** Show further batches. */
  add(batches) {
    for (const batch of batches) {
      batch.material.clippingPlanes = [this.cut];
      // Whoever looks into a cut wall from above sees its far side, not through it.
      if (!batch.material.transparent) batch.material.side = THREE.DoubleSide;
      this.scene.add(batch);
      this.house.batches.push(batch);
    }
    this.draw();
  }

  /** All of the house, from above a corner. */
  overview() {
    this.stopWalking();
    const ball = this.house.box.getBoundingSphere(new THREE.Sphere());
    const half = Math.atan(Math.tan((this.camera.fov * Math.PI) / 360) * Math.min(this.camera.aspect, 1));
    this.controls.target.copy(ball.center);
    this.camera.position.copy(ball.center)
      .addScaledVector(new THREE.Vector3(-0.4, 0.8, 0.45).normalize(), (0.9 * ball.radius) / Math.sin(half));
    this.controls.update();
    this.draw();
  }

  /** Look at a box from the side that one looks from now. */
  frame(box) {
    this.stopWalking();
    const middle = box.getCenter(new THREE.Vector3());
    // Steeply: over the walls, which the ceilings have left open.
    const far = Math.max(box.getSize(new THREE.Vector3()).length() * 1.5, 3.5);
    const way = this.camera.position.clone().sub(this.controls.target).setY(0).normalize();
    this.controls.target.copy(middle);
    this.camera.position.copy(middle).addScaledVector(way, far * 0.3).add(new THREE.Vector3(0, far, 0));
    this.controls.update();
    this.draw();
  }

  /** Walk: floors and openings, in metres, are where one can stand. */
  walk(floors, start, floor = 0) {
    this.controls.enabled = false;
    this.setView(WALK_DEG);
    this.walker = new Walker(this.camera, this.canvas, floors, start, floor + EYE_M, () => this.draw());
    this.draw();
  }

  stopWalking() {
    this.walker?.stop();
    this.walker = null;
    this.controls.enabled = true;
    this.setView(VIEW_DEG);
  }

  setView(degrees) {
    this.camera.fov = degrees;
    this.camera.updateProjectionMatrix();
  }

  /** Cut everything above a height off. */
  cutAt(height) {
    this.cut.constant = height;
    this.draw();
  }

  /** Mark a piece, or nothing. corners: of what it covers of the floor; isWrong: it stands in something. */
  mark(piece, corners = [], isWrong = false) {
    if (this.marked) {
      this.scene.remove(this.marked);
      for (const one of this.marked.children) [one.geometry, one.material].forEach((part) => part.dispose());
    }
    this.marked = null;
    if (piece) {
      const colour = isWrong ? WRONG : RIGHT;
      const box = new THREE.Box3Helper(boxOf(piece), colour);
      this.marked = new THREE.Group().add(box, footprintOf(corners, colour, isWrong ? 0.55 : 0.25));
      for (const one of this.marked.children) one.material.depthTest = false;
      this.scene.add(this.marked);
    }
    this.canvas.dataset.wrong = Boolean(piece && isWrong);
    this.draw();
  }

  resize() {
    const { clientWidth, clientHeight } = this.canvas.parentElement;
    if (!clientWidth || !clientHeight) return;
    this.renderer.setSize(clientWidth, clientHeight, false);
    this.camera.aspect = clientWidth / clientHeight;
    this.camera.updateProjectionMatrix();
    // At once: a canvas of another size is empty.
    if (this.house) this.drawNow();
  }

  draw() {
    this.waits ||= requestAnimationFrame(() => this.drawNow());
  }

  drawNow() {
    cancelAnimationFrame(this.waits);
    this.waits = 0;
    this.renderer.render(this.scene, this.camera);
    this.canvas.dataset.calls = this.renderer.info.render.calls;
    this.canvas.dataset.triangles = this.renderer.info.render.triangles;
  }

  listen() {
    let down = null;
    // Before the controls hear of it: who drags a piece does not turn the house.
    this.canvas.addEventListener("pointerdown", (event) => {
      if (!event.isPrimary || event.button) return;
      down = [event.clientX, event.clientY];
      if (!this.walker) this.grip(event);
    }, { capture: true });
    this.canvas.addEventListener("pointermove", (event) => this.grasp && event.isPrimary && this.pull(event));
    for (const name of ["pointerup", "pointercancel"]) {
      this.canvas.addEventListener(name, (event) => {
        if (!event.isPrimary) return;
        const isStill = down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < STILL_PX;
        down = null;
        const wasPulled = this.grasp?.isPulled;
        this.letGo();
        if (isStill && !wasPulled && name === "pointerup") this.pick(event);
      });
    }
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(this.canvas.parentElement);
  }

  /** Take hold of the piece under the pointer, if it is one to be dragged. */
  grip(event) {
    const hit = this.hit(event);
    const hold = hit && this.held(hit.object.owners[hit.batchId]);
    if (!hold) return;
    const level = new THREE.Plane(new THREE.Vector3(0, 1, 0), -hit.point.y);
    this.grasp = { ...hold, level, from: hit.point, at: [event.clientX, event.clientY], isPulled: false };
    this.controls.enabled = false;
    this.canvas.setPointerCapture(event.pointerId);
  }

  pull(event) {
    const { at, level, from } = this.grasp;
    if (Math.hypot(event.clientX - at[0], event.clientY - at[1]) >= STILL_PX) this.grasp.isPulled = true;
    const place = this.ray(event).ray.intersectPlane(level, new THREE.Vector3());
    if (!this.grasp.isPulled || !place || place.distanceTo(from) > FARTHEST_M) return;
    this.grasp.to([place.x - from.x, from.z - place.z]);
  }

  letGo() {
    if (!this.grasp) return;
    const { end, isPulled } = this.grasp;
    this.grasp = null;
    this.controls.enabled = true;
    if (isPulled) end();
  }

  ray(event) {
    const area = this.canvas.getBoundingClientRect();
    const place = new THREE.Vector2(
      ((event.clientX - area.left) / area.width) * 2 - 1,
      1 - ((event.clientY - area.top) / area.height) * 2,
    );
    // The camera may have moved since the last picture was drawn.
    this.camera.updateMatrixWorld();
    const ray = new THREE.Raycaster();
    ray.setFromCamera(place, this.camera);
    return ray;
  }

  pick(event) {
    if (!this.house) return;
    const seen = this.hit(event);
    this.picked(seen ? seen.object.owners[seen.batchId] : null);
  }

  /** What is seen under a pointer. */
  hit(event) {
    const hits = this.house ? this.ray(event).intersectObjects(this.house.batches, false) : [];
    return hits.find((hit) => hit.object.getVisibleAt(hit.batchId) && hit.point.y <= this.cut.constant);
  }

  /** Nobody sees it any more: what still loads is dropped, and what it shows changes no more. */
  end() {
    this.isOver = true;
    this.stopWalking();
    this.sizes.disconnect();
    cancelAnimationFrame(this.waits);
    this.controls.dispose();
    for (const batch of this.house?.batches ?? []) {
      batch.dispose();
      // three.js takes no change of what is disposed of; edits and models may still be under way.
      batch.setMatrixAt = batch.setVisibleAt = () => batch;
    }
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }
}

/** What a piece covers of the floor. */
function footprintOf(corners, colour, opacity) {
  const geometry = new THREE.BufferGeometry().setFromPoints(corners);
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  const material = new THREE.MeshBasicMaterial({ color: colour, transparent: true, opacity, side: THREE.DoubleSide });
  return new THREE.Mesh(geometry, material);
}
