"""Settings that switch effects of the rig on, with the numbers they need."""

from .models import TORQUE_DRIVEN

MESHES = ("lsp.sun_planet", "lsp.ring_planet", "hsp.sun_planet", "hsp.ring_planet", "psh.mesh")
FRICTION = (
    'effects.mesh_friction = "pitch-point"',
    *(f"stages.{mesh}.friction.coefficient = 0.07" for mesh in MESHES),
    *(f'stages.{mesh}.friction.speed = "0.02 m/s"' for mesh in MESHES),
    'stages.hsp.sun_planet.friction.damping = "3e3 N*s/m"',
    'stages.psh.mesh.friction.damping = "5e2 N*s/m"',
)
BEARING_FRICTION = (
    'effects.bearing_friction = "on"',
    *(f"stages.{stage}.pin.friction = 0.02" for stage in ("lsp", "hsp")),
    *(f'stages.{stage}.pin.diameter = "300 mm"' for stage in ("lsp", "hsp")),
    'stages.hsp.pin.friction_damping = "40 N*m*s/rad"',
)
OPPOSITE = tuple(f'stages.{mesh}.flank = "opposite"' for mesh in MESHES)
ODD = (
    'stages.lsp.planet_angles = ["3 deg", "95.5714286 deg", "180.428571 deg", "267.857143 deg"]',
    'stages.hsp.line_of_centres = "40 deg"',
    'stages.psh.line_of_centres = "-70 deg"',
    "stages.psh.mesh.phase = 0.3",
    'rotors.shaft.drag = "55 N*m*s/rad"',
    'stages.hsp.sun.drag = "21 N*m*s/rad"',
    'gravity = ["2.0 m/s^2", "-9.5 m/s^2"]',
)
PAPER, GRAVITY = 'effects.mesh_law = "paper"', 'effects.gravity = "on"'
SMOOTH = (
    'effects.mesh_stiffness = "smooth"',
    "stages.hsp.sun_planet.transition = 0.25",
    "stages.psh.mesh.transition = 0.06",
    "stages.psh.mesh.phase = 0.3",
    "stages.lsp.ring_planet.phase = -0.4",
)
FOURIER = (
    'effects.mesh_stiffness = "fourier"',
    "stages.hsp.sun_planet.harmonics = 2",
    "stages.psh.mesh.harmonics = 9",
    "stages.psh.mesh.phase = 0.3",
)
TABLE = (
    'effects.mesh_stiffness = "table"',
    'stages.hsp.sun_planet.stiffness_table = [["0.05", "2.1e9 N/m"], ["0.3", "2.6e9 N/m"], ["0.9", "1.9e9 N/m"]]',
    'stages.psh.mesh.stiffness_table = [["0", "1.6e9 N/m"], ["0.25", "1.2e9 N/m"], ["1", "1.6e9 N/m"]]',
    "stages.psh.mesh.harmonics = 3",
)
TORQUE = 'effects.stiffness_torque = "on"'
TRANSMISSION_ERROR = (
    'effects.transmission_error = "on"',
    'stages.lsp.sun_planet.transmission_error.amplitudes = ["8 um", "3 um"]',
    'stages.lsp.sun_planet.transmission_error.phases = ["20 deg", "-75 deg"]',
    'stages.lsp.ring_planet.transmission_error.amplitudes = ["0 um", "4 um", "2 um"]',
    'stages.hsp.ring_planet.transmission_error.amplitudes = ["5 um"]',
    'stages.psh.mesh.transmission_error.amplitudes = ["6 um", "1 um"]',
    "stages.psh.mesh.phase = 0.3",
)
ERROR_TABLE = (
    'effects.transmission_error = "on"',
    'stages.psh.mesh.transmission_error.table = [["0.1", "9 um"], ["0.45", "-3 um"], ["0.8", "2 um"]]',
    "stages.psh.mesh.harmonics = 4",
)
TOOTH_ERRORS = (
    'effects.tooth_errors = "on"',
    'stages.lsp.sun_planet.tooth_errors = [{gear = "sun", tooth = 3, error = "30 um"}, '
    '{gear = "planet", tooth = 20, error = "-25 um"}, {gear = "planet", tooth = 0, error = "40 um", planet = 3}]',
    'stages.hsp.ring_planet.tooth_errors = [{gear = "ring", tooth = 117, error = "15 um"}]',
    'stages.psh.mesh.tooth_errors = [{gear = "input", tooth = 58, error = "20 um"}, '
    + ", ".join(f'{{gear = "output", tooth = {tooth}, error = "-12 um"}}' for tooth in range(0, 21, 3))
    + "]",
)
ONE_FLANK = 'effects.contact = "one-flank"'
BACKLASH = (
    'effects.contact = "backlash"',
    *(f'stages.{mesh}.backlash = "{gap} um"' for mesh, gap in zip(MESHES, (20, 35, 10, 25, 15), strict=True)),
)
ECCENTRICITY = (
    'effects.eccentricity = "on"',
    'stages.lsp.sun.eccentricity = {radius = "40 um", angle = "15 deg"}',
    'stages.lsp.ring.eccentricity = {radius = "90 um", angle = "-100 deg"}',
    'stages.hsp.sun.eccentricity = {radius = "25 um"}',
    'stages.psh.input.eccentricity = {radius = "30 um", angle = "60 deg"}',
    'stages.psh.output.eccentricity = {radius = "20 um", angle = "200 deg"}',
    'stages.lsp.eccentricities = [{planet = 2, radius = "35 um", angle = "80 deg"}, {planet = 4, radius = "10 um"}]',
    'stages.hsp.eccentricities = [{planet = 1, radius = "50 um", angle = "10 deg"}]',
)
POSITION_ERRORS = (
    'effects.planet_position_error = "on"',
    'stages.lsp.position_errors = [{planet = 1, tangential = "40 um"}, {planet = 3, radial = "-30 um"}]',
    'stages.hsp.position_errors = [{planet = 2, radial = "60 um", tangential = "-80 um"}]',
)
RIGID_PINS = 'effects.pins = "rigid"'
RIGID_SHAFTS = 'effects.torsional_shafts = "rigid"'
TORSIONAL = 'effects.lateral = "off"'
DAMPERS = (
    *(f"-stages.{mesh}.damping_ratio" for mesh in MESHES),
    *(
        f'stages.{mesh}.damping = "{c} N*s/m"'
        for mesh, c in zip(MESHES, ("6e4", "3e5", "8e4", "1e5", "4e4"), strict=True)
    ),
    *(f"-couplings.{name}.damping_ratio" for name in ("input_shaft", "lsp_hsp", "hsp_psh", "output_shaft", "flange")),
    'couplings.lsp_hsp.damping = "3e4 N*m*s/rad"',
    'couplings.hsp_psh.damping = "2e3 N*m*s/rad"',
    'couplings.flange.damping = "4e2 N*m*s/rad"',
)
"""Dampers of meshes and couplings as they are, whatever inertia their ratio would refer to."""
CARRIER_BEARING = (
    'stages.hsp.carrier.support = "bearing"',
    'stages.hsp.carrier.bearing.stiffness = "1e9 N/m"',
    "stages.hsp.carrier.bearing.damping_ratio = 0.1",
)
VARIANTS = {
    "rig": (),
    "paper law": (PAPER,),
    "mesh friction": FRICTION,
    "bearing friction": BEARING_FRICTION,
    "gravity": (GRAVITY,),
    "opposite flank": OPPOSITE,
    "torque-driven": TORQUE_DRIVEN,
    "mean stiffness, undamped": (
        'effects.mesh_stiffness = "mean"',
        'effects.damping = "off"',
        'effects.mesh_damping = "off"',
    ),
    "all at once": (PAPER, GRAVITY, *FRICTION, *BEARING_FRICTION, *OPPOSITE, *TORQUE_DRIVEN, *ODD),
    "smooth": SMOOTH,
    "fourier": FOURIER,
    "table": TABLE,
    "smooth with torque": (*SMOOTH, TORQUE),
    "fourier with torque": (*FOURIER, TORQUE),
    "table with torque": (*TABLE, TORQUE),
    "transmission error": TRANSMISSION_ERROR,
    "table of transmission error": ERROR_TABLE,
    "tooth errors": TOOTH_ERRORS,
    "one flank": (ONE_FLANK,),
    "backlash": BACKLASH,
    "backlash with errors": (*BACKLASH, *TRANSMISSION_ERROR, *TOOTH_ERRORS),
    "eccentricity": ECCENTRICITY,
    "eccentricity, smooth with torque": (*ECCENTRICITY, *SMOOTH, TORQUE),
    "position errors": POSITION_ERRORS,
    "rigid pins": (RIGID_PINS, *DAMPERS),
    "rigid pins out of place": (RIGID_PINS, *POSITION_ERRORS, *DAMPERS),
    "rigid pins out of place, held carrier, gravity": (
        *(RIGID_PINS, *POSITION_ERRORS, *DAMPERS, GRAVITY),
        'stages.hsp.carrier.support = "rigid"',
    ),
    "rigid shafts": (RIGID_SHAFTS, *DAMPERS),
    "torsional": (TORSIONAL, *DAMPERS),
    "torsional, pins out of place": (TORSIONAL, *POSITION_ERRORS, *OPPOSITE, *DAMPERS),
    "floating carrier, all of it": (
        *(*SMOOTH, TORQUE, *TRANSMISSION_ERROR, *TOOTH_ERRORS, *ECCENTRICITY, *BACKLASH, GRAVITY),
        *(RIGID_PINS, *POSITION_ERRORS, RIGID_SHAFTS, *DAMPERS),
    ),
    "torsional, all of it": (
        *(TORSIONAL, *SMOOTH, TORQUE, *TRANSMISSION_ERROR, *TOOTH_ERRORS, *BACKLASH, *ECCENTRICITY),
        *(*OPPOSITE, RIGID_SHAFTS, *ODD, *DAMPERS),
    ),
    "torque-driven on rigid pins": (
        *(*TORQUE_DRIVEN, RIGID_PINS, *POSITION_ERRORS, GRAVITY, *FOURIER, TORQUE, *ECCENTRICITY, *ODD),
        *(*OPPOSITE, ONE_FLANK, *TOOTH_ERRORS, *DAMPERS),
    ),
    "torque-driven on rigid shafts": (*TORQUE_DRIVEN, RIGID_SHAFTS, RIGID_PINS, *FRICTION, *DAMPERS),
}
"""The rig under settings: each effect alone, and mixed."""
