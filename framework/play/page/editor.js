// The model's text: highlighted, completed from the registry, with errors at their line.
import { autocompletion, closeBrackets, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { xml, xmlLanguage } from "@codemirror/lang-xml";
import { bracketMatching, HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { lua } from "@codemirror/legacy-modes/mode/lua";
import { lintGutter, setDiagnostics } from "@codemirror/lint";
import { highlightSelectionMatches, searchKeymap } from "@codemirror/search";
import { Compartment, EditorState, StateEffect, StateField } from "@codemirror/state";
import { Decoration, drawSelection, EditorView, highlightActiveLine, keymap, lineNumbers } from "@codemirror/view";
import { tags } from "@lezer/highlight";

const colours = HighlightStyle.define([
  { tag: tags.comment, color: "var(--faint)", fontStyle: "italic" },
  { tag: [tags.tagName, tags.keyword], color: "var(--tag)" },
  { tag: [tags.attributeName, tags.propertyName], color: "var(--attribute)" },
  { tag: [tags.attributeValue, tags.string], color: "var(--value)" },
  { tag: [tags.number, tags.bool], color: "var(--value)" },
  { tag: tags.angleBracket, color: "var(--faint)" },
]);

// What may be written, from the declarations.
function schema(plugins) {
  const everywhere = ["name"], of = { sensor: ["column", "sigma", "range"], joint: ["mass", "com", "link"], effect: ["at", "driver"],
    feature: ["in", "at", "columns", "sigma"] };
  const elements = plugins.filter(p => p.family !== "residual").map(p => ({ name: p.name, completion: { info: p.summary },
    attributes: [...everywhere, ...(of[p.family] ?? []), ...p.inputs.map(i => i.name), ...(p.choices ?? []).map(c => c.name)] }));
  const residuals = plugins.filter(p => p.family === "residual").map(p => p.name);
  elements.push({ name: "talus", top: true, attributes: ["name", "length", "angle", "about"] }, { name: "chain", attributes: ["from", "to"] },
    { name: "parameter", attributes: ["name", "value", "kind"] }, { name: "constant", attributes: ["name", "value"] },
    { name: "unknown", attributes: ["name", "value", "kind", "per"] }, { name: "gravity", attributes: ["in", "x", "y", "z"] },
    { name: "limb", attributes: ["name", "at", "length", "width", "height", "x", "y", "z"] }, { name: "payload", attributes: ["at", "column", "mass"] },
    { name: "calibrate", attributes: [{ name: "residual", values: residuals }, "of", "weight", "loss", "objective"] });
  return { elements };
}

const lightUp = StateEffect.define();
const lit = StateField.define({
  create: () => Decoration.none,
  update(marks, transaction) {
    marks = marks.map(transaction.changes);
    for (const e of transaction.effects)
      if (e.is(lightUp)) {
        const line = e.value > 0 && e.value <= transaction.state.doc.lines ? transaction.state.doc.line(e.value) : null;
        marks = line ? Decoration.set([Decoration.line({ class: "lit" }).range(line.from)]) : Decoration.none;
      }
    return marks;
  },
  provide: field => EditorView.decorations.from(field),
});

// onchange(text), online(line): the text has changed, the cursor stands in another line.
export function createEditor(parent, { onchange, online }) {
  const language = new Compartment();
  let plugins = [], file = "model.xml", line = 0, quiet = false;
  const languageOf = () => file.endsWith(".lua") ? StreamLanguage.define(lua)
    : plugins.length ? xml(schema(plugins)) : xmlLanguage;
  const extensions = [lineNumbers(), history(), drawSelection(), bracketMatching(), closeBrackets(), autocompletion(),
    EditorView.lineWrapping, highlightActiveLine(), highlightSelectionMatches(), lintGutter(), lit, syntaxHighlighting(colours), language.of(languageOf()),
    EditorView.contentAttributes.of({ "aria-label": "The model's text" }), EditorState.tabSize.of(2),
    keymap.of([...defaultKeymap, ...historyKeymap, ...searchKeymap, ...completionKeymap, indentWithTab]),
    EditorView.updateListener.of(update => {
      if (update.docChanged && !quiet) onchange(update.state.doc.toString());
      const now = update.state.doc.lineAt(update.state.selection.main.head).number;
      if (now !== line && update.view.hasFocus) online(line = now);
    })];
  const view = new EditorView({ parent, state: EditorState.create({ extensions }) });
  const position = (row, column) => {  // columns count characters, not halves of them
    const at = view.state.doc.line(Math.max(1, Math.min(row, view.state.doc.lines)));
    return Math.min(at.to, at.from + [...at.text].slice(0, Math.max(0, column - 1)).join("").length);
  };
  return {
    get text() { return view.state.doc.toString(); },
    get file() { return file; },
    view,
    // Another text; with `fresh`, another file, whose past is forgotten.
    set(text, name = file) {
      quiet = true;
      if (name !== file) file = name;
      view.dispatch({ changes: { from: 0, to: view.state.doc.length, insert: text }, effects: language.reconfigure(languageOf()) });
      quiet = false;
      onchange(text);
    },
    grammar(list) { plugins = list; view.dispatch({ effects: language.reconfigure(languageOf()) }); },
    error(e) {
      const list = [];
      if (e) {
        const row = e.line || 1, from = position(row, e.column || 1), end = view.state.doc.lineAt(from).to;
        const word = /^[^\s<>"=/]+/.exec(view.state.sliceDoc(from, end));
        list.push({ from, to: e.column ? Math.min(end, from + (word?.[0].length ?? 1)) : end, severity: "error", message: e.text });
      }
      view.dispatch(setDiagnostics(view.state, list));
    },
    light(row, scroll = false) {
      const effects = [lightUp.of(row)];
      if (scroll && row > 0 && row <= view.state.doc.lines)
        effects.push(EditorView.scrollIntoView(view.state.doc.line(row).from, { y: "center" }));
      view.dispatch({ effects });
    },
    // Replaces an attribute of a named element, as a person would; false where it is not there.
    attribute(name, attribute, value) {
      const text = view.state.doc.toString(), quoted = s => s.replace(/[.*+?^${}()|[\]\\]/g, "\\$&");
      const element = new RegExp(`<\\w+\\b[^<>]*\\bname="${quoted(name)}"[^<>]*?>`).exec(text);
      if (!element) return false;
      const found = new RegExp(`\\b${quoted(attribute)}="([^"]*)"`).exec(element[0]);
      const change = found
        ? { from: element.index + found.index + attribute.length + 2, to: element.index + found.index + attribute.length + 2 + found[1].length, insert: value }
        : { from: element.index + element[0].search(/\s*\/?>$/), insert: ` ${attribute}="${value}"` };
      view.dispatch({ changes: change, selection: { anchor: change.from, head: change.from + change.insert.length } });
      return true;
    },
    // Adds a line before the end of the root element.
    add(element) {
      const text = view.state.doc.toString(), end = text.lastIndexOf("</talus>");
      if (end < 0) return false;
      view.dispatch({ changes: { from: end, insert: `  ${element}\n` }, selection: { anchor: end + 2, head: end + 2 + element.length }, scrollIntoView: true });
      return true;
    },
  };
}
