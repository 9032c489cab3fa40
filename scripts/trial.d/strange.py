"""Physics outside the catalogue, as effects in Lua that only the key knows: steps that are not sharp, bumps, waves whose order
is no whole number, powers, products of two coordinates, chirps."""
import math

from devices import turn
from draw import Truth

# u runs from -1 to 1 over the range of the coordinate that it depends on; v likewise over that of another joint.
FORMS = {
    "smooth step": "tanh(p.a * (u - p.b))",
    "bump": "exp(-(p.a * (u - p.b)) * (p.a * (u - p.b)))",
    "wave": "sin(3.14159265 * (0.8 + 0.37 * p.a) * u + 6 * p.b)",
    "power": "exp(0.75 * log(u * u + 0.0001)) * (1 + p.b * u)",
    "product": "u * v",
    "product of waves": "sin(p.a * u + p.b) * sin(p.a * v)",
    "chirp": "sin(p.a * (1 + p.b + u) * (1 + p.b + u))",
    "sawtooth": "atan2(sin(2 * p.a * u), 1.15 + cos(2 * p.a * u))",
}
TANH = "local function tanh(x) local e = exp(2 * x) return (e - 1) / (e + 1) end\n"
PARTS = {"axis": ("x", "y", "z", "rx", "ry"), "about": ("x", "y", "rx", "ry")}


def drawn(draw, sensors, joints, axes):
    """An effect and the text of its plugin. `axes`: (column, unit, range, joint) of each coordinate."""
    axis = draw.choice(axes)
    joint, sensor = axis[3], sensors.get(axis[3].moved_by)
    acts = draw.choice(["reading", "axis"] if sensor else ["axis", "about"])
    words = draw.choice([f for f in FORMS if acts != "reading" or "product" not in f])
    formula = FORMS[words]
    lua = [TANH + 'effect "strange" {', f'  summary = "{words}",', f'  acts = "{acts}",']
    if acts == "reading":
        dimension, usual = ("length", "0.005 mm") if axis[1] == "mm" else ("angle", "0.05 deg")
        lua.append(f"  on = {dimension},")
        truth, result = Truth("strange", sensor.name, sensor.name), "p.height * s"
        u = scaled("around.reading", axis[2], axis[1])
    else:
        part = draw.choice(PARTS[acts])
        dimension, usual = ("angle", "0.05 deg") if part.startswith("r") else ("length", "0.05 mm")
        truth, result = Truth("strange", joint.name, joint.name), f"{{ {part} = p.height * s }}"
        u = scaled("around.coordinate", turn(axis, sensors), "deg")
    truth.catalogued, truth.words = False, f"{words} ({acts})"
    inputs = [f'height = amount({dimension}, "{usual}", "height")']
    for name, low, high in (("a", 2, 6), ("b", -0.5, 0.5)):
        if f"p.{name}" in formula:
            truth.settings[name] = (draw.uniform(low, high), "1")
            inputs.append(f'{name} = setting(number, {high}, {{}}, "shape")')
    value, unit = usual.split()
    truth.amounts, truth.usual = {"height": (float(value), unit)}, {"height": float(value)}
    if "product" in words:
        other = draw.choice([a for a in axes if a[3].name != joint.name])
        truth.driver = other[3].name
        lua.append('  driver = "other",')
        u += "\n    local v = " + scaled("around.driver", turn(other, sensors), "deg")
    lua.append("  " + ", ".join(inputs) + ",")
    lua.append(f"  value = function(around, p)\n    local u = {u}\n    local s = {formula}\n    return {result}\n  end,\n}}\n")
    return truth, "\n".join(lua)


def scaled(name, span, unit):
    factor = math.radians(1) if unit == "deg" else 1
    middle, half = factor * (span[0] + span[1]) / 2, factor * (span[1] - span[0]) / 2
    return f"({name} - ({middle:.9g})) / {half:.9g}"
