// The 3-D view of the report: A coloured by its distance to B, B translucent, the witness as a line, and motions with a slider.
// tools/bundle bundles it with three.js.
import {AmbientLight, BufferAttribute, BufferGeometry, Color, DirectionalLight, DoubleSide, Group, Line, LineBasicMaterial, Matrix4, Mesh, MeshBasicMaterial,
  MeshLambertMaterial, PerspectiveCamera, Scene, SphereGeometry, Vector3, WebGLRenderer} from "three";
import {OrbitControls} from "three/examples/jsm/controls/OrbitControls.js";

const LEVELS = 65535;
// Five colours of viridis, light where the distance is largest, and one for each bound.
const RAMP = ["#440154", "#3b528b", "#21918c", "#5ec962", "#fde725"].map((text) => new Color(text));
const BOUNDS = ["#e8e4dc", "#e69f00", "#56b4e9", "#009e73", "#d55e00", "#cc79a7"].map((text) => new Color(text));
const BOUND_NAMES = ["exact", "u1", "u2", "u3", "u4", "four nearest triangles"];

const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0)).buffer;

function numbers(packed, width) {
  const whole = new Uint16Array(bytes(packed.data)), found = new Float32Array(whole.length);
  for (let i = 0; i < whole.length; i++) {
    const low = packed.low[i % width], high = packed.high[i % width];
    found[i] = low + (high - low) * (whole[i] / LEVELS);
  }
  return found;
}

function ramp(share) {
  const at = Math.min(Math.max(share, 0), 1) * (RAMP.length - 1), from = Math.min(Math.floor(at), RAMP.length - 2);
  return RAMP[from].clone().lerp(RAMP[from + 1], at - from);
}

function triangles(packed) {
  return packed.wide ? new Uint32Array(bytes(packed.triangles)) : new Uint16Array(bytes(packed.triangles));
}

// Every triangle has corners of its own, so that it can have one colour and a flat shade.
function geometry(packed, colourOf) {
  const corners = numbers(packed.corners, 3), index = triangles(packed), made = new BufferGeometry();
  const positions = new Float32Array(3 * index.length), colours = new Float32Array(3 * index.length);
  for (let i = 0; i < index.length; i++) {
    positions.set(corners.subarray(3 * index[i], 3 * index[i] + 3), 3 * i);
    if (colourOf) colourOf(index[i], Math.floor(i / 3)).toArray(colours, 3 * i);
  }
  made.setAttribute("position", new BufferAttribute(positions, 3));
  if (colourOf) made.setAttribute("color", new BufferAttribute(colours, 3));
  return made;
}

// A pose has nine numbers of the rotation, row by row, then the translation.
function matrix(pose, from) {
  const [a, b, c, d, e, f, g, h, i, x, y, z] = pose.slice(from, from + 12);
  return new Matrix4().set(a, b, c, x, d, e, f, y, g, h, i, z, 0, 0, 0, 1);
}

export class View {
  constructor(canvas, data) {
    this.canvas = canvas;
    this.data = data;
    this.renderer = new WebGLRenderer({canvas, antialias: true, alpha: true});
    this.camera = new PerspectiveCamera(35, 1, 0.01, 100);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.addEventListener("change", () => this.draw());
    canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(canvas.parentElement);
  }

  // Arrow keys turn the view, + and - zoom.
  key(event) {
    const turn = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]}[event.key];
    const offset = this.camera.position.clone().sub(this.controls.target);
    if (turn) {
      offset.applyAxisAngle(this.camera.up, 0.15 * turn[0]);
      offset.applyAxisAngle(new Vector3().crossVectors(this.camera.up, offset).normalize(), 0.15 * turn[1]);
    } else if (event.key === "+" || event.key === "-") {
      offset.multiplyScalar(event.key === "+" ? 0.9 : 1 / 0.9);
    } else {
      return;
    }
    event.preventDefault();
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  show(number, colourBy) {
    const one = this.data.scenes[number];
    this.root?.traverse((part) => { part.geometry?.dispose(); part.material?.dispose(); });
    this.one = one;
    this.root = new Scene();
    this.root.add(new AmbientLight(0xffffff, 1.6));
    const light = new DirectionalLight(0xffffff, 2.2);
    light.position.set(1, 2, 3);
    this.root.add(light);
    this.a = new Group();
    this.b = new Group();
    const a = this.data.meshes[one.a], coloured = this.colours(one, colourBy);
    this.a.add(new Mesh(geometry(a, coloured), new MeshLambertMaterial({vertexColors: Boolean(coloured), color: coloured ? 0xffffff : 0x4f6db8,
      side: DoubleSide, flatShading: true})));
    this.b.add(new Mesh(geometry(this.data.meshes[one.b]), new MeshLambertMaterial({color: 0x999999, transparent: true, opacity: 0.25, side: DoubleSide,
      depthWrite: false, polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 1})));
    this.root.add(this.a, this.b);
    this.line = null;
    if (one.witness) {
      const ends = new BufferGeometry().setAttribute("position", new BufferAttribute(new Float32Array(one.witness), 3));
      this.line = new Group().add(new Line(ends, new LineBasicMaterial({color: 0xd55e00, depthTest: false, transparent: true})));
      this.ball = new Mesh(new SphereGeometry(1, 16, 12), new MeshBasicMaterial({color: 0xd55e00, depthTest: false, transparent: true}));
      this.ball.position.set(one.witness[0], one.witness[1], one.witness[2]);
      this.line.add(this.ball);
      this.line.children.forEach((part) => { part.renderOrder = 1; });
      this.root.add(this.line);
    }
    this.pose(0);
    this.frame(a, this.data.meshes[one.b]);
  }

  colours(one, by) {
    if (by === "distance" && one.colours.distance) {
      const values = numbers(one.colours.distance, 1), [low] = one.colours.distance.low, [high] = one.colours.distance.high;
      const shades = Array.from(values, (value) => ramp((value - Math.min(low, 0)) / (high - Math.min(low, 0) || 1)));
      return (corner) => shades[corner];
    }
    if (by === "bound" && one.colours.bound) {
      const values = new Uint8Array(bytes(one.colours.bound));
      return (corner, triangle) => BOUNDS[Math.min(values[triangle], BOUNDS.length - 1)];
    }
    return null;
  }

  pose(k) {
    const pose = this.one.poses[k];
    for (const [group, from] of [[this.a, 0], [this.b, 12]]) {
      group.matrixAutoUpdate = false;
      group.matrix.copy(matrix(pose, from));
      group.matrixWorldNeedsUpdate = true;
    }
    this.draw();
  }

  // Looks at the middle of the first and the last pose from a distance at which everything is seen.
  frame(a, b) {
    const low = new Vector3(Infinity, Infinity, Infinity), high = new Vector3(-Infinity, -Infinity, -Infinity);
    for (const pose of [this.one.poses[0], this.one.poses[this.one.poses.length - 1]]) {
      for (const [packed, from] of [[a, 0], [b, 12]]) {
        const moved = matrix(pose, from), ends = [packed.corners.low, packed.corners.high];
        for (let k = 0; k < 8; k++) {
          const corner = new Vector3(ends[k & 1][0], ends[(k >> 1) & 1][1], ends[k >> 2][2]).applyMatrix4(moved);
          low.min(corner);
          high.max(corner);
        }
      }
    }
    const middle = low.clone().add(high).multiplyScalar(0.5), radius = high.distanceTo(low) / 2 || 1;
    if (this.line) this.ball.scale.setScalar(radius / 100);
    this.controls.target.copy(middle);
    this.camera.near = radius / 100;
    this.camera.far = radius * 100;
    this.camera.position.copy(middle).add(new Vector3(0.6, 0.45, 1).normalize().multiplyScalar(0.8 * radius / Math.sin(Math.PI * 17.5 / 180)));
    this.controls.update();
    this.resize();
  }

  resize() {
    const width = this.canvas.parentElement.clientWidth, height = Math.round(Math.min(0.62 * width, 640));
    this.renderer.setPixelRatio(Math.min(devicePixelRatio, 2));
    this.renderer.setSize(width, height, false);
    this.canvas.style.width = `${width}px`;
    this.canvas.style.height = `${height}px`;
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }

  draw() {
    if (this.root) this.renderer.render(this.root, this.camera);
  }
}

window.hausbenchView = {View, BOUND_NAMES, boundColours: BOUNDS.map((colour) => `#${colour.getHexString()}`), ramp: RAMP.map((colour) => `#${colour.getHexString()}`)};
