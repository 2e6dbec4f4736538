"""Settings that switch effects of the rig on, with the numbers they need."""

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
