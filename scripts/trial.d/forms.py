"""Forms of the model: the nominal geometry with its tolerances and some effects beside it, written and fitted."""
import re

import command


class Forms:
    def __init__(self, folder, nominal):
        self.folder, self.nominal = folder, nominal

    def write(self, file, text, elements, lua=""):
        own = ['<plugin file="strange.lua"/>'] if lua else []
        if own:  # plugins stand before what they define
            text = re.sub(r"(<talus\b[^>]*>)", lambda m: m[1] + "\n  " + own[0], text, count=1)
        text = text.replace("</talus>", "".join(f"  {e}\n" for e in elements) + "</talus>")
        (self.folder / file).write_text(text, encoding="utf-8")

    def fit(self, recordings, elements, lua=""):
        """`baseline` of the calibration of nominal geometry and free effects."""
        self.write("form.xml", self.nominal, elements, lua)
        return command.calibrate(self.folder, "form.xml", recordings)
