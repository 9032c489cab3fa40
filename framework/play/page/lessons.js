// Lessons: Markdown with a few lines of settings before it; links to "do:..." act on the page.
import { marked } from "marked";
import { h } from "../../page/dom.js";
import ankleText from "../../../docs/lessons/ankle.md";
import ankleModel from "../../../docs/lessons/ankle.xml";
import dhText from "../../../docs/lessons/dh.md";
import dhModel from "../../../docs/lessons/dh.xml";
import encoderText from "../../../docs/lessons/encoder.md";
import encoderModel from "../../../docs/lessons/encoder.xml";

// ---\n title: ...\n poses: 60\n faults: <element .../>\n---\n text
function lesson(id, file, text, model) {
  const [, head, body] = /^---\n([^]*?)\n---\n([^]*)$/.exec(text), settings = {};
  for (const line of head.split("\n")) {
    const [, name, value] = /^(\w+): *(.*)$/.exec(line);
    settings[name] = value;
  }
  const hidden = { poses: +(settings.poses ?? 60), seed: +(settings.seed ?? 1), what: settings.what ?? "simulated",
                   faults: settings.faults ? `<talus>${settings.faults}</talus>` : "" };
  return { id, file, model, body, title: settings.title, hidden };
}
export const lessons = [lesson("dh", "dh.xml", dhText, dhModel), lesson("ankle", "ankle.xml", ankleText, ankleModel),
  lesson("encoder", "encoder.xml", encoderText, encoderModel)];

export function lessonView(lesson, act) {
  const view = h("div");
  view.innerHTML = marked.parse(lesson.body);  // of this file's own text
  for (const link of view.querySelectorAll("a[href^='do:']")) {
    const words = decodeURIComponent(link.getAttribute("href").slice(3));
    const button = h("button", { type: "button", class: "do", onclick: async () => {
      button.disabled = true;
      try { await act(words); } finally { button.disabled = false; }
      button.classList.add("done");
    } }, ...link.childNodes);
    button.title = words;
    link.replaceWith(button);
  }
  return view;
}
