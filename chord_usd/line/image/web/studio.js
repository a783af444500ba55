// A house, its light, and one picture after another. Python calls the functions at the end.
import { GLTFLoader, THREE } from "./three.js";

/** Light of a room by day beside its lamps, in units of the house's file. */
const AMBIENT = 0.3;
const SKY = [1.5, 1.8, 2.2];
const WINDOW_CANDELA_M2 = 1.6;
const MOST_WINDOWS = 3;
const MOST_LAMPS = 8;
const SUN = 0.35;
/** glTF's rectangles shine over half a sphere; a shadow map sees less. */
const WIDEST = 1.25;
const OCCLUDER_M = 0.35;
/** Z up, as the stage has it, to Y up. */
const Y_UP = new THREE.Matrix4().set(1, 0, 0, 0, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 1);

const QUAD = "varying vec2 at; void main() { at = uv; gl_Position = vec4(position.xy, 1.0, 1.0); }";

/** Ambient light that near things take: a spiral of points around each pixel, on depth alone. */
const OCCLUDE = `
  uniform sampler2D colour, depth;
  uniform mat4 unproject;
  uniform vec2 reach, size;
  varying vec2 at;
  vec3 place(vec2 uv) {
    vec4 p = unproject * vec4(vec3(uv, texture2D(depth, uv).r) * 2.0 - 1.0, 1.0);
    return p.xyz / p.w;
  }
  void main() {
    gl_FragColor = texture2D(colour, at);
    if (texture2D(depth, at).r == 1.0) return;
    vec3 here = place(at), normal = normalize(cross(dFdx(here), dFdy(here)));
    float turn = 6.2832 * fract(52.9829 * fract(dot(floor(at * size), vec2(0.06711, 0.00584)))), hidden = 0.0;
    for (int k = 0; k < 16; k += 1) {
      float far = (float(k) + 0.5) / 16.0, angle = turn + 2.39996 * float(k);
      vec3 way = place(at + reach * far * vec2(cos(angle), sin(angle)) / -here.z) - here;
      float away = dot(way, way);
      hidden += max(dot(way, normal) - 0.012, 0.0) * inversesqrt(away + 1e-6) * max(0.0, 1.0 - away / ${OCCLUDER_M ** 2});
    }
    gl_FragColor.rgb *= 1.0 - min(hidden / 8.0, 0.75);
  }`;

/** AgX with some contrast, as Blender's pictures have it; steps at edges are blurred along these (FXAA). */
const DEVELOP = `
  uniform sampler2D colour;
  uniform vec2 pixel;
  varying vec2 at;
  vec3 tone(vec2 away) {
    vec3 c = linearToOutputTexel(vec4(toneMapping(texture2D(colour, at + away * pixel).rgb), 1.0)).rgb;
    return mix(c, c * c * (3.0 - 2.0 * c), 0.4);
  }
  float luma(vec3 c) { return dot(c, vec3(0.299, 0.587, 0.114)); }
  void main() {
    vec3 here = tone(vec2(0.0));
    float m = luma(here), nw = luma(tone(vec2(-1.0, 1.0))), ne = luma(tone(vec2(1.0)));
    float sw = luma(tone(vec2(-1.0))), se = luma(tone(vec2(1.0, -1.0)));
    float low = min(m, min(min(nw, ne), min(sw, se))), high = max(m, max(max(nw, ne), max(sw, se)));
    vec2 way = vec2(sw + se - nw - ne, nw + sw - ne - se);
    way = clamp(way / (min(abs(way.x), abs(way.y)) + 0.03 * (nw + ne + sw + se) + 0.008), -8.0, 8.0);
    vec3 near = 0.5 * (tone(way / -6.0) + tone(way / 6.0));
    vec3 far = 0.5 * near + 0.25 * (tone(way * -0.5) + tone(way * 0.5));
    gl_FragColor = vec4(luma(far) < low || luma(far) > high ? near : far, 1.0);
  }`;

const SHAPE = `
  varying vec3 facing;
  varying float away;
  void main() {
    vec4 seen = modelViewMatrix * vec4(position, 1.0);
    facing = mat3(modelMatrix) * normal;
    away = -seen.z;
    gl_Position = projectionMatrix * seen;
  }`;
/** Number of the thing, distance along the axis, and two parts of the normal in the stage's frame. */
const DATA = `
  uniform float number;
  varying vec3 facing;
  varying float away;
  void main() {
    vec3 n = normalize(gl_FrontFacing ? facing : -facing);
    gl_FragColor = vec4(number + (n.y < 0.0 ? 0.25 : 0.0), away, n.x, -n.z);
  }`;

class Studio {
  async open(address, numbers) {
    const gltf = await new GLTFLoader().loadAsync(address);
    this.house = gltf.scene;
    this.scene = new THREE.Scene().add(this.house);
    this.scene.updateMatrixWorld(true);
    this.renderer = new THREE.WebGLRenderer({ preserveDrawingBuffer: true });
    this.renderer.setPixelRatio(1);
    this.renderer.toneMapping = THREE.AgXToneMapping;
    Object.assign(this.renderer.shadowMap, { enabled: true, type: THREE.PCFSoftShadowMap, autoUpdate: false });
    this.quad = new THREE.Mesh(new THREE.PlaneGeometry(2, 2));
    this.quad.frustumCulled = false;
    this.eye = new THREE.Camera();
    [this.meshes, this.lamps, this.windows] = [[], [], []];
    this.house.traverse((node) => this.sort(node, numbers));
    this.surround();
  }

  sort(node, numbers) {
    const { category, room } = node.userData;
    if (node.isMesh) this.prepare(node, numbers);
    if (node.isDirectionalLight) this.sun = this.sunOf(node);
    else if (node.isLight) this.lamps.push({ light: node, room: above(node, (one) => one.userData.kind && one.userData.room) });
    if (category === "window" && room) {
      const box = new THREE.Box3().setFromObject(node), size = box.getSize(new THREE.Vector3());
      this.windows.push({ room, middle: box.getCenter(new THREE.Vector3()), area: size.y * Math.max(size.x, size.z) });
    }
  }

  prepare(mesh, numbers) {
    const lit = mesh.material;
    const number = above(mesh, (one) => numbers[one.userData.path]) ?? 0;
    mesh.castShadow = mesh.receiveShadow = !lit.transparent;
    lit.side = lit.shadowSide = THREE.DoubleSide;
    const data = new THREE.ShaderMaterial({ vertexShader: SHAPE, fragmentShader: DATA, side: THREE.DoubleSide, uniforms: { number: { value: number } } });
    lit.userData.plain ??= new THREE.MeshBasicMaterial({ color: lit.color, map: lit.map, side: THREE.DoubleSide });
    this.meshes.push({ mesh, lit, data, plain: lit.userData.plain });
  }

  /** The sun shines into every room alike: its shadows are drawn once. */
  sunOf(sun) {
    const box = new THREE.Box3().setFromObject(this.house), ball = box.getBoundingSphere(new THREE.Sphere());
    const way = new THREE.Vector3(0, 0, 1).transformDirection(sun.matrixWorld);
    const own = new THREE.DirectionalLight(sun.color, SUN * sun.intensity);
    own.position.copy(ball.center).addScaledVector(way, 2 * ball.radius);
    own.target.position.copy(ball.center);
    own.castShadow = true;
    own.shadow.mapSize.set(2048, 2048);
    const { radius: r } = ball;
    Object.assign(own.shadow.camera, { left: -r, right: r, bottom: -r, top: r, near: 0, far: 4 * r });
    Object.assign(own.shadow, { bias: -0.0005, normalBias: 0.02, autoUpdate: false, needsUpdate: true });
    sun.visible = false;
    this.scene.add(own, own.target);
    return own;
  }

  /** What a room's surfaces give each other: from a pale ceiling most, from the floor least. */
  surround() {
    const box = new THREE.Scene();
    const sides = [0.75, 0.75, 1.3, 0.4, 0.75, 0.75].map((bright) => new THREE.MeshBasicMaterial({ color: new THREE.Color(bright, bright * 0.98, bright * 0.94), side: THREE.BackSide }));
    box.add(new THREE.Mesh(new THREE.BoxGeometry(4, 2.5, 4), sides));
    const maker = new THREE.PMREMGenerator(this.renderer);
    this.scene.environment = maker.fromScene(box, 0.04).texture;
    this.scene.environmentIntensity = AMBIENT;
    this.scene.background = new THREE.Color(...SKY);
    maker.dispose();
  }

  /** Let the lamps of these rooms shine, and their windows. */
  light(rooms) {
    for (const { light, room } of this.lamps) Object.assign(light, { visible: rooms.includes(room), castShadow: false });
    const lit = this.lamps.map(({ light }) => light).filter((light) => light.visible).sort((a, b) => b.intensity - a.intensity);
    lit.slice(MOST_LAMPS).forEach((light) => (light.visible = false));
    const main = lit.find((light) => light.isSpotLight);
    for (const light of lit.filter((one) => one.isSpotLight)) Object.assign(light, { angle: WIDEST, penumbra: 1 });
    if (main) {
      main.castShadow = true;
      main.shadow.mapSize.set(1024, 1024);
      Object.assign(main.shadow, { bias: -0.0005, normalBias: 0.02, radius: 8, needsUpdate: true });
      Object.assign(main.shadow.camera, { near: 0.05, far: 20 });
    }
    this.panes?.forEach((pane) => this.scene.remove(pane, pane.target));
    const seen = this.windows.filter(({ room }) => rooms.includes(room)).sort((a, b) => b.area - a.area);
    this.panes = seen.slice(0, MOST_WINDOWS).map((window) => this.pane(window));
    this.renderer.shadowMap.needsUpdate = true;
  }

  pane({ room, middle, area }) {
    const floor = this.meshes.map(({ mesh }) => mesh).find(({ userData: said }) => said.category === "floor" && said.room === room);
    const inwards = (floor ? new THREE.Box3().setFromObject(floor).getCenter(new THREE.Vector3()) : middle.clone()).setY(middle.y).sub(middle).normalize();
    const light = new THREE.SpotLight(0xe8f0ff, WINDOW_CANDELA_M2 * area, 0, 1.45, 1, 2);
    light.position.copy(middle).addScaledVector(inwards, -0.4);
    light.target.position.copy(middle).add(inwards).setY(middle.y - 0.35);
    this.scene.add(light, light.target);
    return light;
  }

  /** The camera of a view: matrix, focal length, aperture and shift as the stage has them. */
  aim(view, [width, height]) {
    const camera = new THREE.PerspectiveCamera(), [near, far] = view.clip_m;
    camera.matrixAutoUpdate = false;
    camera.matrix.copy(Y_UP).multiply(new THREE.Matrix4().set(...view.matrix.flat()));
    camera.updateMatrixWorld(true);
    const half = ((view.aperture_m / view.focal_m) * near) / 2, rise = (half * height) / width;
    const [right, up] = view.shift.map((share) => 2 * half * share);
    camera.projectionMatrix.makePerspective(right - half, right + half, up + rise, up - rise, near, Math.min(far, 200));
    camera.projectionMatrixInverse.copy(camera.projectionMatrix).invert();
    camera.reach = [(OCCLUDER_M * near) / (2 * half), (OCCLUDER_M * near) / (2 * rise)];
    return camera;
  }

  target(type, more = {}) {
    const [width, height] = this.size;
    return new THREE.WebGLRenderTarget(width, height, { type, minFilter: THREE.NearestFilter, magFilter: THREE.NearestFilter, ...more });
  }

  wear(kind) {
    for (const one of this.meshes) one.mesh.material = one[kind];
  }

  draw(target, scene = this.scene, camera = this.camera) {
    this.renderer.setRenderTarget(target);
    this.renderer.render(scene, camera);
  }

  /** A shader over all of a target. */
  pass(fragmentShader, values, target) {
    const uniforms = Object.fromEntries(Object.entries(values).map(([name, value]) => [name, { value }]));
    this.quad.material = new THREE.ShaderMaterial({ vertexShader: QUAD, fragmentShader, uniforms, depthTest: false });
    this.draw(target, this.quad, this.eye);
    this.quad.material.dispose();
  }

  read(target, kind) {
    const [width, height] = this.size, pixels = new kind(4 * width * height);
    this.renderer.readRenderTargetPixels(target, 0, 0, width, height, pixels);
    return packed(pixels);
  }

  /** Light that the view sees, and what colour things have there: halves, rows from the bottom. */
  shoot(view, size, rooms) {
    this.size = size;
    this.camera = this.aim(view, size);
    this.light(rooms);
    const [width, height] = size;
    const raw = this.target(THREE.HalfFloatType, { depthTexture: new THREE.DepthTexture(width, height, THREE.FloatType) });
    this.wear("lit");
    this.draw(raw);
    this.shot?.dispose();
    this.shot = this.target(THREE.HalfFloatType, { magFilter: THREE.LinearFilter, minFilter: THREE.LinearFilter });
    const { reach, projectionMatrixInverse: unproject } = this.camera;
    this.pass(OCCLUDE, { colour: raw.texture, depth: raw.depthTexture, unproject, reach: new THREE.Vector2(...reach), size: new THREE.Vector2(width, height) }, this.shot);
    raw.dispose();
    const plain = this.target(THREE.HalfFloatType);
    this.wear("plain");
    this.draw(plain);
    const taken = { light: this.read(this.shot, Uint16Array), albedo: this.read(plain, Uint16Array) };
    plain.dispose();
    return taken;
  }

  /** The last shot as a PNG, at an exposure. */
  develop(exposure) {
    this.renderer.toneMappingExposure = exposure;
    this.renderer.setSize(...this.size);
    const [width, height] = this.size;
    this.pass(DEVELOP, { colour: this.shot.texture, pixel: new THREE.Vector2(1 / width, 1 / height) }, null);
    return this.renderer.domElement.toDataURL("image/png").split(",")[1];
  }

  /** Numbers, depths and normals of what the view sees: floats, rows from the bottom; 0 for nothing. */
  measure(view, size) {
    this.size = size;
    this.camera = this.aim(view, size);
    const target = this.target(THREE.FloatType), { background } = this.scene;
    this.scene.background = null;
    this.wear("data");
    this.draw(target);
    this.scene.background = background;
    const taken = this.read(target, Float32Array);
    target.dispose();
    return taken;
  }
}

/** What a node, or the nearest above it, is asked for. */
function above(node, asked) {
  for (let one = node; one; one = one.parent) if (asked(one)) return asked(one);
}

function packed(pixels) {
  const bytes = new Uint8Array(pixels.buffer), parts = [];
  for (let at = 0; at < bytes.length; at += 0x8000) parts.push(String.fromCharCode(...bytes.subarray(at, at + 0x8000)));
  return btoa(parts.join(""));
}

const studio = new Studio();
window.opened = (address, numbers) => studio.open(address, numbers);
window.shoot = (view, size, rooms) => studio.shoot(view, size, rooms);
window.develop = (exposure) => studio.develop(exposure);
window.measure = (view, size) => studio.measure(view, size);
window.ready = true;
