// What the page shows at the moment: which state, which pose, the coordinates, what is lit. Whoever
// changes it calls one of the functions; whoever shows it listens.
import { valuesAt } from "./linkage.js";

// Lists as pack.h has them, as arrays of numbers and nulls.
function unpacked(list, of, data) {
  if (Array.isArray(list)) return list;
  if ("column" in list) return of[list.column].values;
  if ("state" in list) return data.states[list.state].coordinates[list.coordinate];
  const bytes = Uint8Array.from(atob(list.f32), c => c.charCodeAt(0)), view = new DataView(bytes.buffer);
  return Array.from({ length: bytes.length / 4 }, (_, i) => {
    const v = view.getFloat32(4 * i, true);
    return Number.isFinite(v) ? +v.toPrecision(7) : null;
  });
}
export function unpack(data) {
  for (const state of data.states) {
    const columns = state.columns ?? data.columns, take = list => unpacked(list, columns, data);
    state.coordinates = state.coordinates.map(take);
    for (const row of state.rows) if (row.residuals) row.residuals = take(row.residuals);
    for (const name in state.offsets) state.offsets[name] = state.offsets[name].map(take);
  }
  return data;
}

const transposed = rows => rows.length ? rows[0].map((_, i) => rows.map(row => row[i])) : [];

export function makeStore(data, functions) {
  data.linkages.forEach((scene, i) => {
    scene.evaluate = functions[i];
    scene.base = data.states.find(s => s.linkage === i).base;
  });
  // Limits that nobody has stated go as far as the poses do.
  for (const state of [...data.states, { linkage: data.states[0].linkage, coordinates: transposed(data.next) }])
    data.linkages[state.linkage].coordinates.forEach((c, i) => {
      if (!c.limited) for (const v of state.coordinates[i] ?? [])
        if (Number.isFinite(v)) { c.low = Math.min(c.low, v); c.high = Math.max(c.high, v); }
    });
  const listeners = { posture: [], state: [], pose: [], lit: [] };
  const tell = what => listeners[what].forEach(f => f());
  const poses = state => state.coordinates.length ? state.coordinates[0].length : 0;
  const store = {
    data,
    state: data.states.length - 1,
    pose: -1,          // number of the recorded row; -1: none
    lit: null,         // "joint:NAME", "frame:NUMBER", "feature:NAME"
    values: new Map(), // of the coordinates by name, in the units of the model
    changes: null,     // of slots, beside the state's own: [[slot, amount]]
    on(what, f) { listeners[what].push(f); },
    get current() { return data.states[store.state]; },
    get scene() { return data.linkages[store.current.linkage]; },
    sceneOf: state => data.linkages[state.linkage],
    // States that have poses of their own come first; others borrow those of the current one.
    withPoses: () => poses(store.current) ? store.current : data.states.find(poses),
    poseCount() { const s = store.withPoses(); return s ? poses(s) : 0; },
    coordinates(state, pose = -1) {
      const scene = store.sceneOf(state);
      return scene.coordinates.map((c, i) => {
        const own = pose >= 0 && state.coordinates.length ? state.coordinates[i][pose] : null;
        return own ?? store.values.get(c.name) ?? c.rest;
      });
    },
    // Where the linkage is as another state has it: at the same readings, with its own unknowns.
    outputs(state) {
      const scene = store.sceneOf(state);
      let base = state.base;
      if (state === store.current && store.changes) {
        base = Float64Array.from(base);
        for (const [slot, amount] of store.changes) base[slot] += amount;
      }
      return valuesAt(scene, store.coordinates(state, store.pose), base);
    },
    setState(i) {
      store.state = i;
      store.changes = null;
      if (store.pose >= store.poseCount()) { store.pose = store.poseCount() - 1; tell("pose"); }
      if (store.pose >= 0) store.take(store.pose);
      tell("state");
      tell("posture");
    },
    take(pose) {
      const state = store.withPoses();
      store.sceneOf(state).coordinates.forEach((c, i) => {
        const v = state.coordinates[i]?.[pose];
        if (Number.isFinite(v)) store.values.set(c.name, v);
      });
    },
    setPose(pose) {
      if (!store.poseCount()) return;
      store.pose = Math.max(0, Math.min(store.poseCount() - 1, pose));
      store.take(store.pose);
      tell("pose");
      tell("posture");
    },
    set(name, value) {
      store.values.set(name, value);
      if (store.pose >= 0) { store.pose = -1; tell("pose"); }
      tell("posture");
    },
    // Between two recorded poses, for playing; `share` from 0 to 1.
    between(pose, share) {
      const state = store.withPoses(), next = Math.min(pose + 1, poses(state) - 1);
      store.take(pose);
      if (share > 0) store.sceneOf(state).coordinates.forEach((c, i) => {
        const a = state.coordinates[i][pose], b = state.coordinates[i][next];
        if (!Number.isFinite(a) || !Number.isFinite(b)) return;
        let d = b - a;
        if (c.unit === "deg" && Math.abs(d) > 180) d -= 360 * Math.round(d / 360);
        store.values.set(c.name, a + share * d);
      });
      store.pose = share > 0 ? -1 : pose;
      tell("pose");
      tell("posture");
    },
    rest() {
      store.values.clear();
      store.pose = -1;
      store.changes = null;
      tell("pose");
      tell("posture");
    },
    setAll(scene, list) {
      scene.coordinates.forEach((c, i) => { if (Number.isFinite(list[i])) store.values.set(c.name, list[i]); });
      store.pose = -1;
      tell("pose");
      tell("posture");
    },
    vary(changes) { store.changes = changes; tell("posture"); },
    light(key) { store.lit = key === store.lit ? null : key; tell("lit"); },
    // The part of the picture that a name of the model stands for.
    keyOf(name) {
      if (!name) return null;
      const scene = store.scene;
      const part = name.split(".")[0];
      if (scene.axes.some(a => a.joint === part)) return "joint:" + part;
      const frame = scene.frames.findIndex(f => f.name === part || f.label === part);
      const c = scene.coordinates.findIndex(c => c.name === part || c.column === part);
      const axis = c >= 0 && scene.axes.find(a => a.coordinates.includes(c));
      if (axis) return "joint:" + axis.joint;
      if (scene.features.some(f => f.name === part)) return "feature:" + part;
      return frame >= 0 ? "frame:" + frame : null;
    },
    nameOf(key) {
      if (!key) return null;
      const [kind, ...rest] = key.split(":"), id = rest.join(":");
      return kind === "frame" ? store.scene.frames[+id]?.name : id;
    },
  };
  return store;
}
