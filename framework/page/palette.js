// Colours, after Okabe and Ito and Tol: told apart by the colour-blind, in grey by their lightness.
const light = {
  paper: "#ffffff", ink: "#222222", faint: "#6b7480", rule: "#d5dade",
  x: "#d55e00", y: "#009e73", z: "#0072b2",
  rod: "#97a3af", rod2: "#c2cbd4", stem: "#7b8794", joint: "#f0b030", axis: "#7a5000",
  apart: "#aa3377", feature: "#222222", arrow: "#cc3311", lit: "#0077bb",
  limbs: ["#bbccee", "#eeeebb", "#ffcccc", "#ccddaa", "#cceeff", "#dddddd"],
  before: "#b8860b", after: "#0072b2", heldout: "#aa3377", effect: "#d55e00",
  ghosts: ["#aa3377", "#6b7a00", "#5e4fa2", "#a0522d"],
};
const dark = {
  ...light,
  paper: "#14181c", ink: "#e8eaec", faint: "#9aa5b0", rule: "#39424b",
  x: "#ff8f40", y: "#2fc99a", z: "#56b4e9",
  rod: "#8e9aa6", rod2: "#66727e", stem: "#77838f", joint: "#e0a83a", axis: "#e5c07a",
  apart: "#ee88bb", feature: "#e8eaec", arrow: "#ff7a5c", lit: "#66ccff",
  limbs: ["#44557a", "#6b6b40", "#7a4c4c", "#56693c", "#3f6878", "#5a5a5a"],
  before: "#e6b84c", after: "#56b4e9", heldout: "#ee88bb", effect: "#ff8f40",
  ghosts: ["#ee88bb", "#bcc85a", "#a99be8", "#d9925f"],
};

// Paper is always light.
export function palette() {
  const is = query => typeof matchMedia === "function" && matchMedia(query).matches;
  return is("(prefers-color-scheme: dark)") && !is("print") ? dark : light;
}
