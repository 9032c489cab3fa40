// Paints shapes by WebGL. Shapes of one sort are one instanced mesh, so a linkage is a handful of
// draw calls. Throws where there is no WebGL.
import {
  AmbientLight, BoxGeometry, Color, ConeGeometry, CylinderGeometry, DirectionalLight, DynamicDrawUsage,
  InstancedMesh, Matrix4, MeshLambertMaterial, OrthographicCamera, Quaternion, Scene, SphereGeometry,
  Vector3, WebGLRenderer,
} from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { add, norm, sub, times } from "./linkage.js";

const along = new Vector3(0, 1, 0), one = new Vector3(1, 1, 1);

export function webglPainter(element) {
  const canvas = document.createElement("canvas");
  // The context is made here so that a machine without one is not reported as an error.
  const options = { antialias: true, alpha: false, preserveDrawingBuffer: true };
  const context = canvas.getContext("webgl2", options);
  if (!context) throw new Error("no WebGL");
  const renderer = new WebGLRenderer({ canvas, context, ...options });
  element.append(canvas);
  const scene = new Scene(), camera = new OrthographicCamera();
  const sun = new DirectionalLight(0xffffff, 1.9);
  scene.add(new AmbientLight(0xffffff, 1.5), sun, sun.target);
  const geometries = {
    rods: new CylinderGeometry(1, 1, 1, 20), cones: new ConeGeometry(1, 1, 16),
    balls: new SphereGeometry(1, 16, 12), boxes: new BoxGeometry(1, 1, 1), solid: new BoxGeometry(1, 1, 1),
  };
  const meshes = {}, lines = new Map(), matrix = new Matrix4(), turn = new Quaternion(), colour = new Color();

  function mesh(kind, count) {
    let m = meshes[kind];
    if (!m || m.instanceMatrix.count < count) {
      if (m) { scene.remove(m); m.material.dispose(); m.dispose(); }
      const faded = kind === "boxes" ? { transparent: true, opacity: 0.5, depthWrite: false } : {};
      m = new InstancedMesh(geometries[kind], new MeshLambertMaterial(faded), Math.max(16, 2 * count));
      m.instanceMatrix.setUsage(DynamicDrawUsage);
      m.frustumCulled = false;
      meshes[kind] = m;
      scene.add(m);
    }
    m.count = count;
    return m;
  }
  function place(kind, list, matrixOf, lit, colours) {
    const m = mesh(kind, list.length);
    list.forEach((s, i) => {
      matrixOf(s);
      m.setMatrixAt(i, matrix);
      m.setColorAt(i, colour.set(lit && s.key === lit ? colours.lit : s.colour));
    });
    m.instanceMatrix.needsUpdate = true;
    if (m.instanceColor) m.instanceColor.needsUpdate = true;
  }
  const between = (a, b, radius) => {
    const d = sub(b, a), length = norm(d), middle = times(0.5, add(a, b));
    turn.setFromUnitVectors(along, new Vector3(...times(1 / (length || 1), d)));
    matrix.compose(new Vector3(...middle), turn, new Vector3(radius, length, radius));
  };

  function placeLines(all, lit, colours) {
    const groups = new Map([...lines.keys()].map(width => [width, []]));
    for (const s of all) {
      if (!groups.has(s.width)) groups.set(s.width, []);
      groups.get(s.width).push(s);
    }
    for (const [width, list] of groups) {
      const positions = [], rgb = [];
      for (const s of list) {
        colour.set(lit && s.key === lit ? colours.lit : s.colour);
        const length = norm(sub(s.b, s.a)), d = times(1 / (length || 1), sub(s.b, s.a));
        const step = s.dash || length, drawn = s.dash ? 0.6 * s.dash : length;
        for (let at = 0, n = 0; at < length && n < 400; at += step, ++n) {
          positions.push(...add(s.a, times(at, d)), ...add(s.a, times(Math.min(length, at + drawn), d)));
          rgb.push(colour.r, colour.g, colour.b, colour.r, colour.g, colour.b);
        }
      }
      let drawn = lines.get(width);
      if (drawn) { scene.remove(drawn); drawn.geometry.dispose(); }
      if (!positions.length) { lines.delete(width); drawn?.material.dispose(); continue; }
      const geometry = new LineSegmentsGeometry();
      geometry.setPositions(positions);
      geometry.setColors(rgb);
      const material = drawn?.material ?? new LineMaterial({ linewidth: width, vertexColors: true });
      drawn = new LineSegments2(geometry, material);
      drawn.frustumCulled = false;
      lines.set(width, drawn);
      scene.add(drawn);
    }
  }

  return {
    kind: "webgl", canvas,
    resize(width, height) {
      renderer.setPixelRatio(globalThis.devicePixelRatio || 1);
      renderer.setSize(width, height);
    },
    paint(view, shapes, colours, lit) {
      renderer.setClearColor(colours.paper);
      place("rods", shapes.rods, s => between(s.a, s.b, s.radius), lit, colours);
      place("cones", shapes.cones,
            s => between(sub(s.at, times(s.length, s.direction)), s.at, s.radius), lit, colours);
      place("balls", shapes.balls, s => {
        turn.identity();
        matrix.compose(new Vector3(...s.at), turn, one.clone().multiplyScalar(s.radius));
      }, lit, colours);
      const box = s => {
        matrix.makeBasis(...s.axes.map((a, i) => new Vector3(...times(s.size[i], a))));
        matrix.setPosition(...s.centre);
      };
      place("boxes", shapes.boxes.filter(s => !s.solid), box, lit, colours);
      place("solid", shapes.boxes.filter(s => s.solid), box, lit, colours);
      placeLines(shapes.lines, lit, colours);
      const { towards, right, up } = view.basis(), w = view.width / 2 / view.scale, h = view.height / 2 / view.scale;
      const depth = 4 * Math.max(w, h, 1);
      Object.assign(camera, { left: -w, right: w, top: h, bottom: -h, near: 0, far: 4 * depth });
      camera.position.set(...add(view.target, times(2 * depth, towards)));
      camera.up.set(...up);
      camera.lookAt(...view.target);
      camera.updateProjectionMatrix();
      sun.position.set(...add(view.target, add(times(2, towards), add(times(1.2, up), times(-0.8, right)))));
      sun.target.position.set(...view.target);
      renderer.render(scene, camera);
    },
    dispose() {
      for (const m of Object.values(meshes)) { m.material.dispose(); m.dispose(); }
      for (const l of lines.values()) { l.geometry.dispose(); l.material.dispose(); }
      for (const g of Object.values(geometries)) g.dispose();
      renderer.dispose();
      canvas.remove();
    },
  };
}
