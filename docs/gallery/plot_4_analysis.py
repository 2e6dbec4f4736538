"""
What a result shows
===================

Lines of a spectrum and what causes them, the load that each planet carries, and the whole
as one page.
"""

# %%
# A stage with one pin out of place
# ---------------------------------
# The four planets of the rig's low-speed stage share the load equally as long as all pins
# stand where they should. In the scene ``floating-on`` one stands 50 um off.

import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from ltcgear.runtime import analysis, build, simulate, view, write_report
from ltcgear.symbolic import build_model, describe_scene, generate, load_scene

scene = load_scene("floating-on")
model = build_model(scene)
result = simulate(
    build(generate(model)),
    model.values(),
    t_end=1.0,
    rate=8192.0,
    attributes=describe_scene(scene),
)

share = analysis.find_load_share(analysis.cut(result.dataset, 0.5, 1.0), "lsp.sun_planet")
for mesh, mean in zip(share.meshes, share.mean, strict=True):
    print(f"{mesh}: {mean:.3f} of an equal share")
figure = view.draw_shares(share)
plt.show()

# %%
# The sun floats, so it moves until opposite planets carry the same; the other pair takes
# what these two leave.

assert abs(share.mean[0] - share.mean[2]) < 2e-3
assert abs(np.sum(share.mean) - 4) < 1e-9

# %%
# Lines and their causes
# ----------------------
# A flat-top window reads amplitudes right between bins too.

force = result.mesh["lsp.sun_planet.1"].force.sel(time=slice(0.5, None))
spectrum = analysis.find_spectrum(force, window="flattop")
lines = analysis.name_lines(spectrum, analysis.find_clues(result.dataset), signals=(force,))
for line in lines[:5]:
    print(f"{line.place:8.1f} Hz  {line.amplitude:8.0f} N  {line.name}")
figure = view.draw_spectrum(spectrum, lines)
plt.show()

# %%
# One page
# --------
# ``write_report`` writes stages in motion, figures and tables as one page of HTML that
# needs no network; ``ltcgear report`` adds the modes.

page = write_report(result, Path(tempfile.mkdtemp()) / "lsp.html")
print(f"{page.stat().st_size / 1e6:.1f} MB")
