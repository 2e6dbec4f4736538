"""What messages about scenes advise: scene, defect, what is told, and each cure that the message names.

Dotted keys are put into a shipped scene; ``...`` takes one away. A cure is put in on top of the defect.
"""

L, P, M, S = "stages.lsp.", "stages.psh.", "stages.psh.mesh.", "stages.lsp.sun_planet."
DEVICE = {"synchronous_speed": "1500 rpm", "breakdown_torque": "290 N*m", "breakdown_slip": 0.18}
ROTOR = {"inertia": "1 kg*m^2"}
RAMP = [["0 s", "15 rpm"], ["1 s", "20 rpm"]]
STEP = [["0 s", "0 N*m"], ["1 s", "9 N*m"]]
GEAR = {"support": "rigid", "inertia": "1 kg*m^2", "bearing": ..., "disc": ...}
BEARING = {"stiffness": "1e8 N/m"}
TOOTH = {"gear": "sun", "tooth": 1, "error": "1 um"}
RUBBING = {"effects.mesh_friction": "sliding", S + "friction": {"coefficient": 0.1}}
BARE = {P + "module": ..., P + "pressure_angle": ..., P + "helix_angle": ..., M + "double_factor": ...,
        P + "input.base_radius": "250 mm", P + "output.base_radius": "89 mm",
            P + "center_distance": "365 mm"}  # fmt: skip

GENERAL = {
    "misspelt key": ("lsp", {L + "modul": "16 mm"}, 'unknown key; did you mean "module"?', [{L + "modul": ...}]),
    "missing key": ("lsp", {L + "sun": ...}, "stages.lsp.sun: is missing", [{L + "sun": {"teeth": 22, "disc": {
        "outer_diameter": "352 mm", "width": "400 mm"}}}]),
    "no kind": ("psh", {P + "kind": ...}, 'write kind = "planetary" or kind = "pair"', [{P + "kind": "pair"}]),
    "bad name": ("lsp", {"rotors.Big": ROTOR}, "names are small letters", [{"rotors.Big": ..., "rotors.big": ROTOR,
        "loads.b": {
        "member": "big", "speed": "0 rpm"}}]),
    "set name": ("lsp", {"name": "x"}, "remove it", [{"name": ...}]),
    "source alone": ("lsp", {L + "module": {"source": "printed: x"}},
        'write { value = ..., source = "printed: where" }',
                     [{L + "module": {"value": "16 mm", "source": "printed: where"}}]),
    "unknown label": ("lsp", {L + "module": {"value": "16 mm", "source": "x"}}, 'must begin with "printed: "',
                      [{L + "module": {"value": "16 mm", "source": f"{label}: x"}} for label in (
                          "printed", "derived", "assumed", "fitted")]),
    "title of lines": ("lsp", {"title": "a\nb"}, "leave it out", [{"title": "ab"}]),
    "empty title": ("lsp", {"title": ""}, "must not be empty", [{"title": "a"}]),
    "long title": ("lsp", {"title": "a" * 201}, "200 characters at most", [{"title": "a" * 200}]),
    "number as title": ("lsp", {"title": 3}, "must be text in quotes", [{"title": "3"}]),
    "teeth as text": ("lsp", {L + "sun.teeth": "22"}, "a whole number without quotes", [{L + "sun.teeth": 22}]),
    "ratio as text": ("lsp", {L + "pin.damping_ratio": "0.03"}, "a number without quotes and unit",
                      [{L + "pin.damping_ratio": 0.03}]),
    "list as gear": ("lsp", {L + "sun": []}, "must be a table", [{L + "sun": {"teeth": 22, "support": "rigid",
        **ROTOR}}]),
    "gravity of three": ("lsp", {"gravity": ["1 m/s^2"] * 3}, "2 items at most", [{"gravity": ["1 m/s^2"] * 2}]),
    "no unit": ("lsp", {L + "module": 16}, 'write it like "16 mm"', [{L + "module": "16 mm"}]),
    "wrong unit": ("lsp", {"loads.ring.speed": "15 Hz"}, 'write it like "15 rpm"', [{"loads.ring.speed": "15 rpm"}]),
    "list": ("lsp", {L + "pin.stiffness": [1]}, 'write it like "5.02e9 N/m"', [{L + "pin.stiffness": "5.02e9 N/m"}]),
    "slip of a unit": ("lsp", {L + "planet.disc.width": "400e9 mm"}, "check number and unit",
                       [{L + "planet.disc.width": "400 mm"}]),
    "zero mass": ("lsp", {L + "pin.stiffness": "0 N/m"}, "must be greater than zero", [{L + "pin.stiffness": "1 N/m"}]),
    "wrong effect": ("lsp", {"effects.mesh_lwa": "paper"}, 'did you mean "mesh_law"?',
                     [{"effects.mesh_lwa": ..., "effects.mesh_law": "paper"}]),
    "wrong value": ("lsp", {"effects.mesh_law": "papre"}, 'did you mean "paper"?', [{"effects.mesh_law": "paper"}]),
    "wrong choice": ("lsp", {L + "sun.support": "floatng"}, '"floating"?', [{L + "sun.support": "floating"}]),
    "no member": ("lsp", {"stages": {}, "loads": {}}, "add a stage or a rotor", [{"rotors.a": ROTOR}]),
    "two dampings": ("lsp", {L + "pin.damping": "1 N*s/m"}, "give either damping or damping_ratio, not both",
                     [{L + "pin.damping": ...}, {L + "pin.damping_ratio": ...}]),
    "many samples": ("lsp", {"simulation.rate": "1e11 Hz"}, "lower one", [{"simulation.rate": "1e6 Hz"},
                                                                      {"simulation.t_end": "1e-4 s"}]),
    "still rayleigh": ("lsp", {"rayleigh": {}}, "give mass or stiffness, or both", [
        {"rayleigh.mass": "1 1/s"}, {"rayleigh.stiffness": "1 us"}, {"rayleigh.mass": "1 1/s",
            "rayleigh.stiffness": "1 us"}]),
    "negative rayleigh": ("lsp", {"rayleigh": {"mass": "-1 1/s"}}, "must not be negative",
        [{"rayleigh.mass": "1 1/s"}]),
}  # fmt: skip

MEMBERS = {
    "wide bore": ("lsp", {L + "sun.disc.inner_diameter": "3 m"}, "between zero and outer_diameter",
                  [{L + "sun.disc.inner_diameter": "0 m"}]),
    "tight bearing": ("lsp", {L + "ring.bearing.clearance": "-1 um"},
        "must not be negative; a bearing that is preloaded",
                      [{L + "ring.bearing.clearance": ...}, {L + "ring.bearing.clearance": "0 um"}]),
    "pin without lever": ("lsp", {L + "pin.friction": 0.1}, "pin.diameter: is missing",
        [{L + "pin.diameter": "0.3 m"}]),
    "bearing alone": ("lsp", {L + "sun.bearing": BEARING}, "belong together", [
        {L + "sun.support": "bearing"}, {L + "sun.bearing": ...}]),
    "clamped and sprung": ("lsp", {L + "carrier.torsional_support": {"stiffness": "1 N*m/rad"}},
                           "drop torsional_support, or free the member", [
        {L + "carrier.torsional_support": ...}, {L + "carrier": {"support": "rigid", **ROTOR, "torsional_support": {
            "stiffness": "1 N*m/rad"}}}]),
    "disc and mass": ("lsp", {L + "sun.mass": "3 kg"}, "give either a disc, or mass and inertia", [
        {L + "sun.mass": ...}, {L + "sun.disc": ..., L + "sun.inertia": "1 kg*m^2"}]),
    "mass alone": ("lsp", {L + "sun.disc": ..., L + "sun.mass": "3 kg"}, "inertia is missing", [
        {L + "sun.inertia": "1 kg*m^2"}, {L + "sun.mass": ..., L + "sun.disc": {"outer_diameter": "1 m",
            "width": "1 m"}}]),
    "drag of a planet": ("lsp", {L + "planet.drag": "1 N*m*s/rad"}, "leave drag out", [{L + "planet.drag": ...}]),
    "planet off centre": ("lsp", {L + "planet.eccentricity": {"radius": "1 um"}},
                          "give the stage eccentricities = [{ planet = 1, radius = ... }]",
                          [{L + "planet.eccentricity": ..., L + "eccentricities": [{"planet": 1, "radius": "1 um"}]}]),
    "planet 5": ("lsp", {L + "position_errors": [{"planet": 5, "radial": "1 um"}]}, "must be one of 1 to 4, each once",
                 [{L + "position_errors": [{"planet": 4, "radial": "1 um"}]}]),
    "angles for one": ("lsp", {L + "planet_angles": ["0 deg"]}, "give one a planet",
                       [{L + "planet_angles": [f"{a} deg" for a in (0, 90, 180, 270)]}]),
    "massless rotor": ("lsp", {"rotors.a": {}}, "give either inertia or a disc", [
        {"rotors.a.inertia": "1 kg*m^2", "loads.a": {"member": "a", "speed": "0 rpm"}},
        {"rotors.a.disc": {"outer_diameter": "1 m", "width": "1 m"}, "loads.a": {"member": "a", "speed": "0 rpm"}}]),
    "taken name": ("lsp", {"rotors.lsp": ROTOR}, "choose another", [
        {"rotors.lsp": ..., "rotors.b": ROTOR, "loads.b": {"member": "b", "speed": "0 rpm"}}]),
    "reserved name": ("lsp", {"rotors.origin": ROTOR}, "choose another", [
        {"rotors.origin": ..., "rotors.b": ROTOR, "loads.b": {"member": "b", "speed": "0 rpm"}}]),
    "all afloat": ("lsp", {L + "ring.support": "floating", L + "ring.bearing": ..., L + "carrier": {
        "mass": "1 kg", "inertia": "1 kg*m^2"}, "loads.c": {"member": "lsp.carrier", "speed": "0 rpm"}},
        "give one of them a bearing", [{L + "sun.support": "bearing", L + "sun.bearing": BEARING}]),
    "pair afloat": ("psh", {P + "input.support": "floating", P + "input.bearing": ...}, "give it a bearing",
                    [{P + "input.support": "bearing", P + "input.bearing": BEARING}]),
}  # fmt: skip

TEETH = {
    "flat teeth": ("lsp", {L + "pressure_angle": "90 deg"}, "between 0 and 45 deg", [{L + "pressure_angle": "20 deg"}]),
    "steep helix": ("psh", {P + "helix_angle": "90 deg"}, "between -45 and 45 deg", [{P + "helix_angle": "9 deg"}]),
    "module alone": ("lsp", {L + "pressure_angle": ...}, "pressure_angle: is missing",
        [{L + "pressure_angle": "20 deg"}]),
    "thick teeth": ("lsp", {L + "sun.tooth_thinning": "-1 um"}, "must not be less than zero",
                    [{L + "sun.tooth_thinning": "1 um"}]),
    "thinning without module": ("psh", BARE | {P + "input.tooth_thinning": "1 um"}, "give the mesh's backlash",
                                [{P + "input.tooth_thinning": ..., M + "backlash": "1 um"}]),
    "no teeth": ("lsp", {L + "sun.teeth": ...}, "or base_radius", [
        {L + "sun.teeth": 22}, {L + "sun.base_radius": "165.386 mm", L + "center_distance": "560 mm",
                                S + "double_factor": ..., L + "ring_planet.contact_ratio": 1.8}]),
    "two radii": ("lsp", {L + "sun.base_radius": "0.2 m"}, "drop one of them", [{L + "sun.base_radius": ...}]),
    "small ring": ("lsp", {L + "ring.teeth": 48}, "must be larger than the planet", [{L + "ring.teeth": 118}]),
    "no distance": ("psh", BARE | {P + "center_distance": ...}, "center_distance: is missing",
                    [{P + "center_distance": "365 mm"}]),
    "low shifts": ("lsp", {L + "sun.profile_shift": -1.9, L + "planet.profile_shift": -1.9}, "give larger ones",
                   [{L + "sun.profile_shift": 0.0, L + "planet.profile_shift": 0.0}]),
    "two distances": ("lsp", {L + "sun.profile_shift": 0.5}, "let the profile shifts agree, or give center_distance",
                      [{L + "sun.profile_shift": 0.0}, {L + "center_distance": "566 mm",
                                                            L + "ring_planet.double_factor": ...}]),
    "far apart": ("lsp", {L + "center_distance": "5.6 m"}, "check teeth, module and center_distance",
                  [{L + "center_distance": "560 mm"}]),
    "too near": ("lsp", {L + "center_distance": "100 mm"}, "check teeth, module and center_distance",
                 [{L + "center_distance": "560 mm"}]),
    "radii against teeth": ("psh", BARE | {P + "input.teeth": 30, P + "output.teeth": 20}, "drop base_radius or teeth",
                            [{P + "input.teeth": ..., P + "output.teeth": ...}]),
    "planets between teeth": ("lsp", {L + "planet_angles": ["0 deg", "91 deg", "180 deg", "270 deg"]},
                              'the nearest place is "90 deg"',
                              [{L + "planet_angles": ["0 deg", "90 deg", "180 deg", "270 deg"]}]),
    "three planets": ("lsp", {L + "planets": 3}, "give planet_angles",
                      [{L + "planet_angles": ["0 deg", f"{360 / 140 * 47!r} deg", f"{360 / 140 * 93!r} deg"]}]),
    "crowded planets": ("lsp", {L + "planets": 5}, "take fewer planets", [{L + "planets": 4}]),
    "crowded angles": ("lsp", {L + "planet_angles": ["0 deg", "360 deg", "180 deg", "270 deg"]}, "take fewer planets",
                       [{L + "planets": 3, L + "planet_angles": ["0 deg", "180 deg", "270 deg"]}]),
    "coarse error": ("lsp", {L + "pin.clearance": "20 mm"}, "16 mm at most", [{L + "pin.clearance": "16 mm"}]),
    "negative backlash": ("psh", {M + "backlash": "-1 um"}, "must not be less than zero", [{M + "backlash": "0 um"}]),
}  # fmt: skip

MESHES = {
    "two stiffnesses": ("psh", {M + "stiffness": "1e8 N/m"}, "give either stiffness, or torsional_stiffness", [
        {M + "stiffness": ...}, {M + "torsional_stiffness": ..., M + "reference": ...}]),
    "no stiffness": ("psh", {M + "torsional_stiffness": ..., M + "reference": ..., P + "helix_angle": "0 deg"},
                     "or face_width", [
        {M + "stiffness": "1e8 N/m"}, {M + "torsional_stiffness": "1e8 N*m/rad", M + "reference": "input"},
        {M + "face_width": "200 mm", M + "double_factor": ...}]),
    "no reference": ("psh", {M + "reference": ...}, "belong together", [{M + "reference": "input"}]),
    "reference elsewhere": ("psh", {M + "reference": "sun"}, "must be one of input, output", [
        {M + "reference": "input"}, {M + "reference": "output"}]),
    "nearly whole": ("psh", {M + "contact_ratio": 1.0000005}, "give 1", [{M + "contact_ratio": 1}]),
    "open table": ("psh", {M + "stiffness_table": [[0, "1e9 N/m"], [1, "2e9 N/m"]]}, "a pitch must close",
                   [{M + "stiffness_table": [[0, "1e9 N/m"], [1, "1e9 N/m"]]}]),
    "short table": ("psh", {M + "stiffness_table": [[0, "1e9 N/m"], [0.3, "2e9 N/m"]]}, "give it over the whole pitch",
                    [{M + "stiffness_table": [[0, "1e9 N/m"], [0.6, "2e9 N/m"]]}]),
    "late table": ("psh", {M + "stiffness_table": [[0, "1e9 N/m"], [1.3, "1e9 N/m"]]}, "must lie between 0 and 1",
                   [{M + "stiffness_table": [[0, "1e9 N/m"], [1, "1e9 N/m"]]}]),
    "soft table": ("psh", {M + "stiffness_table": [[0, "0 N/m"], [0.8, "1e9 N/m"]]}, "must be greater than zero",
                   [{M + "stiffness_table": [[0, "1e8 N/m"], [0.8, "1e9 N/m"]]}]),
    "swinging table": ("psh", {M + "stiffness_table": [[0.2, "1e9 N/m"], [0.5, "9e9 N/m"], [0.8, "1e9 N/m"]],
                               M + "harmonics": 1}, "give harmonics = 2", [{M + "harmonics": 2}]),
    "jumping table": ("psh", {M + "stiffness_table": [[0, "1e8 N/m"], [0.5, "9e9 N/m"], [0.501, "1e8 N/m"]]},
                      "smooth the table", [{M + "stiffness_table": [[0, "9e8 N/m"], [0.5, "9e9 N/m"]]}]),
    "no error": ("psh", {M + "transmission_error": {}}, "give either amplitudes or a table", [
        {M + "transmission_error.amplitudes": ["1 um"]},
        {M + "transmission_error.table": [[0, "0 um"], [0.5, "1 um"], [1, "0 um"]]}]),
    "phases too many": ("psh", {M + "transmission_error": {"amplitudes": ["1 um"], "phases": ["1 deg"] * 2}},
                        "give one each, or none", [
        {M + "transmission_error.phases": ["1 deg"]}, {M + "transmission_error.phases": ...}]),
    "wide transition": ("lsp", {S + "transition": 0.9}, "at most", [{S + "transition": 0.1}]),
    "tooth twice": ("lsp", {S + "tooth_errors": [TOOTH] * 2}, "keep one", [{S + "tooth_errors": [TOOTH]}]),
    "tooth elsewhere": ("lsp", {S + "tooth_errors": [TOOTH | {"gear": "ring"}]}, "must be one of sun, planet", [
        {S + "tooth_errors": [TOOTH]}, {S + "tooth_errors": [TOOTH | {"gear": "planet"}]}]),
    "tooth 22": ("lsp", {S + "tooth_errors": [TOOTH | {"tooth": 22}]}, "teeth 0 to 21",
                 [{S + "tooth_errors": [TOOTH | {"tooth": 21}]}]),
    "tooth of planet 5": ("lsp", {S + "tooth_errors": [TOOTH | {"planet": 5}]}, "leave it out to mean all",
                          [{S + "tooth_errors": [TOOTH]}]),
    "width without teeth": ("psh", BARE | {M + "torsional_stiffness": ..., M + "reference": ...,
        M + "face_width": "1 m"},
                            "give stiffness instead", [{M + "face_width": ..., M + "stiffness": "1e8 N/m"}]),
    "helical width": ("psh", {M + "torsional_stiffness": ..., M + "reference": ..., M + "face_width": "0.2 m"},
                      "give stiffness for helical ones", [{M + "face_width": ..., M + "stiffness": "1e8 N/m"}]),
    "width and ratio": ("psh", {M + "torsional_stiffness": ..., M + "reference": ..., M + "face_width": "0.2 m",
                                P + "helix_angle": "0 deg", M + "double_factor": ..., M + "contact_ratio": 1.5},
                        "drop one of them", [
        {M + "contact_ratio": ...}, {M + "face_width": ..., M + "stiffness": "1e8 N/m"}]),
    "factor without teeth": ("psh", BARE | {M + "double_factor": 1.2, P + "input.teeth": ..., P + "output.teeth": ...},
                             "need the teeth of both gears", [{P + "input.teeth": 59, P + "output.teeth": 21,
                                                               M + "contact_ratio": 1.5}]),
    "factor without module": ("psh", BARE | {M + "double_factor": 1.2}, "contact_ratio: is missing",
                              [{M + "contact_ratio": 1.5}]),
    "ratio beyond two": ("lsp", {L + "pressure_angle": "1 deg"}, "give contact_ratio, or drop double_factor", [
        {S + "contact_ratio": 1.6, L + "ring_planet.contact_ratio": 1.8},
        {S + "double_factor": ..., L + "ring_planet.double_factor": ...}]),
    "tips cut in": ("psh", {P + "input.teeth": 5, P + "output.teeth": 5}, "give contact_ratio, or drop double_factor", [
        {M + "contact_ratio": 1.2}, {M + "double_factor": ...}]),
    "whole ratio": ("lsp", {S + "contact_ratio": 2, S + "tooth_errors": [TOOTH]}, "give one between 1 and 2",
                    [{S + "contact_ratio": 1.6}]),
    "sliding whole": ("lsp", RUBBING | {S + "contact_ratio": 1}, "give one between 1 and 2",
        [{S + "contact_ratio": 1.6}]),
    "sliding bare": ("psh", BARE | {"effects.mesh_friction": "sliding", M + "friction": {"coefficient": 0.1}},
                     "sliding needs the teeth of both gears, module and pressure_angle; give them",
                     [{P + "module": "9 mm", P + "pressure_angle": "20 deg", P + "helix_angle": "8 deg",
                       P + "input.base_radius": ..., P + "output.base_radius": ..., P + "center_distance": ...}]),
    "sliding past": ("psh", {"effects.mesh_friction": "sliding", M + "friction": {"coefficient": 0.1},
                             P + "input.teeth": 12, P + "output.teeth": 12, M + "contact_ratio": 1.9},
                     "give a smaller one", [{M + "contact_ratio": 1.1}]),
}  # fmt: skip

LOADS = {
    "stranger": ("lsp", {"loads.sun.member": "lsp.snu"}, 'did you mean "lsp.sun"?', [{"loads.sun.member": "lsp.sun"}]),
    "one end": ("rig-2mw", {"couplings.flange.between": ["shaft", "shaft"]}, "both ends are 'shaft'",
                [{"couplings.flange.between": ["shaft", "generator"]}]),
    "clamped and driven": ("lsp", {"loads.sun.member": "lsp.carrier"}, "free it or drop the load", [
        {"loads.sun": ...}, {L + "carrier": {"support": "rigid", **ROTOR}, "loads.c": {
            "member": "lsp.sun", "speed": "0 rpm"}}]),
    "two speeds": ("lsp", {"loads.b": {"member": "lsp.ring", "speed": "15 rpm"}}, "keep one", [{"loads.b": ...}]),
    "sprung and driven": ("lsp", {L + "ring.torsional_support": {"stiffness": "1 N*m/rad"}},
        "drop the support or the speed",
                          [{L + "ring.torsional_support": ...}, {"loads.ring": ...}]),
    "sprung on the way": ("lsp", {L + "sun.torsional_support": {"stiffness": "1 N*m/rad"}}, "drop it",
                          [{L + "sun.torsional_support": ...}]),
    "nothing": ("lsp", {"loads.sun": {"member": "lsp.sun"}}, "give either speed or torque, one of",
                [{"loads.sun.torque": "1 N*m"}]),
    "both": ("lsp", {"loads.ring.torque": "1 N*m"}, "not speed and torque", [{"loads.ring.torque": ...}]),
    "start of a speed": ("lsp", {"loads.ring.initial_speed": "1 rpm"}, "goes with torque",
                         [{"loads.ring.initial_speed": ...}]),
    "zero table": ("lsp", {"loads.ring.speed": ..., "loads.ring.speed_over_time": [["0 s", "0 rpm"], ["1 s", "0 rpm"]]},
                   'write speed = "0 rpm"', [{"loads.ring.speed_over_time": ..., "loads.ring.speed": "0 rpm"}]),
    "slip of nothing": ("lsp", {"loads.sun": {"member": "lsp.sun", "slip": DEVICE | {"synchronous_speed": "0 rpm"}}},
                        "must not be zero", [{"loads.sun.slip.synchronous_speed": "-80 rpm"}]),
    "open speed": ("lsp", {L + "carrier": {"support": "rigid", **ROTOR}}, "give a speed or fix a member", [
        {"loads.c": {"member": "lsp.carrier", "speed": "0 rpm"}}, {L + "carrier": {"support": "fixed"}}]),
    "contradiction": ("lsp", {"loads.sun": {"member": "lsp.sun", "speed": "1 rpm"}}, "give fewer speeds",
                      [{"loads.sun": ...}]),
    "from rest": ("psh", {"loads.input": {"member": "psh.input", "torque_over_time": STEP}},
                  'give one load an initial_speed ("0 rpm" from rest)', [
        {"loads.input.initial_speed": "0 rpm"}, {"loads.output.initial_speed": "0 rpm"}]),
    "start beside a table": ("lsp", {"loads.ring": {"member": "lsp.ring", "speed_over_time": RAMP},
                                     "loads.sun.initial_speed": "1 rpm"}, "drop it",
                                     [{"loads.sun.initial_speed": ...}]),
    "speed beside a table": ("lsp", {"loads.ring": {"member": "lsp.ring", "speed_over_time": RAMP}, L + "carrier": {
        "support": "rigid", **ROTOR}, "loads.c": {"member": "lsp.carrier", "speed": "1 rpm"}}, "it must be zero",
        [{"loads.c.speed": "0 rpm"}]),
    "two tables": ("lsp", {"loads.ring": {"member": "lsp.ring", "speed_over_time": RAMP}, L + "carrier": {
        "support": "rigid", **ROTOR}, "loads.c": {"member": "lsp.carrier", "speed_over_time": [["0 s", "1 rpm"],
            ["1 s", "9 rpm"]]}},
        "one speed alone may vary", [
            {"loads.c.speed_over_time": [["0 s", "30 rpm"], ["1 s", "40 rpm"]]},
            {"loads.c.speed_over_time": ..., "loads.c.speed": "0 rpm"}]),
    "late table": ("lsp", {"loads.ring": {"member": "lsp.ring", "speed_over_time": [["-2 s", "1 rpm"], ["-1 s",
        "0 rpm"]]}},
                   "give a speed", [{"loads.ring": {"member": "lsp.ring", "speed": "1 rpm"}}]),
    "steps back": ("lsp", {"loads.sun": {"member": "lsp.sun", "torque_over_time": [STEP[1], STEP[0]]}},
                   "sort the rows, and keep one of each", [{"loads.sun.torque_over_time": STEP}]),
    "one row": ("lsp", {"loads.sun": {"member": "lsp.sun", "torque_over_time": [STEP[0]]}},
                'write it like [["0 s", "0 N*m"], ["1 s", "1 N*m"]]',
                [{"loads.sun.torque_over_time": [["0 s", "0 N*m"], ["1 s", "1 N*m"]]}]),
    "no file": ("lsp", {"loads.sun": {"member": "lsp.sun", "torque_over_time": "gone.csv"}},
                'or write it like [["0 s", "0 N*m"], ["1 s", "1 N*m"]]',
                [{"loads.sun.torque_over_time": [["0 s", "0 N*m"], ["1 s", "1 N*m"]]}]),
}  # fmt: skip

ADVISED = (
    GENERAL
    | MEMBERS
    | TEETH
    | {f"mesh, {k}": v for k, v in MESHES.items()}
    | {f"load, {k}": v for k, v in LOADS.items()}
)
