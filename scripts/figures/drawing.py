"""Pictures of the docs as SVG: lines, dots and words on white."""
import html, pathlib

BLUE, ORANGE, GREY, INK = "#2a6f97", "#d1611f", "#b8bcc2", "#23272c"


class Drawing:
    def __init__(self, width, height):
        self.size, self.parts = (width, height), []

    def add(self, tag, text=None, **attributes):
        inside = " ".join(f'{k.replace("_", "-")}="{v:.2f}"' if isinstance(v, float) else f'{k.replace("_", "-")}="{v}"'
                          for k, v in attributes.items())
        self.parts.append(f"<{tag} {inside}/>" if text is None else f"<{tag} {inside}>{html.escape(text)}</{tag}>")

    def text(self, x, y, words, size=12, anchor="start", fill=INK, **more):
        self.add("text", words, x=float(x), y=float(y), font_size=size, text_anchor=anchor, fill=fill, **more)

    def line(self, x1, y1, x2, y2, stroke=INK, width=1, **more):
        self.add("line", x1=float(x1), y1=float(y1), x2=float(x2), y2=float(y2), stroke=stroke, stroke_width=width, **more)

    def dot(self, x, y, r, fill, **more):
        self.add("circle", cx=float(x), cy=float(y), r=r, fill=fill, **more)

    def save(self, file):
        w, h = self.size
        head = (f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {w} {h}" width="{w}" height="{h}" '
                'font-family="Helvetica, Arial, DejaVu Sans, sans-serif">')
        pathlib.Path(file).write_text("\n".join([head, f'<rect width="{w}" height="{h}" fill="white"/>', *self.parts,
                                                 "</svg>"]) + "\n", encoding="utf-8")
