"""A simulation result made of sines whose amplitudes, phases and slopes are known.

The second half of the record lasts 2 s, so bins are 0.5 Hz apart and every
frequency below falls on one. The first half carries a start-up transient.
"""

import numpy as np
import xarray as xr

RATE = 8192.0
DURATION = 4.0
STEADY = 2.0
LSP, HSP, PSH = 29.5, 158.0, 628.0
FREE = 45.0  # no combination of the three and a carrier's turns
ALPHA = np.deg2rad(20.0)

# group: meshes, mean [N], amplitude [N], frequency [Hz]
FORCES = {
    "lsp.sun_planet": (4, 3.5e5, 0.5e5, LSP),
    "lsp.ring_planet": (4, 3.6e5, 0.4e5, LSP),
    "hsp.sun_planet": (3, 1.0e5, 0.3e5, HSP),
    "hsp.ring_planet": (3, 1.1e5, 0.2e5, HSP),
    "psh.mesh": (0, -1.2e5, 0.3e5, PSH),  # loaded on the other flank
}

# member: frequency -> (amplitude along x, amplitude along y) [m/s^2]
TONES = {
    "lsp.ring": {},  # at rest by symmetry
    "lsp.planet.1": {LSP: (0.3, 0.4), 2 * HSP: (1.2, 0.5), FREE: (0.2, 0.0)},
    "lsp.sun": {LSP: (0.1, 0.1)},
    "hsp.carrier": {3 * HSP: (2.0, 0.0), HSP - LSP: (0.6, 0.8)},
    # One turn of the carrier, 8.4 rad/s or 1.34 Hz, below its mesh: 156.66 Hz, nearest bin 156.5 Hz.
    "hsp.sun": {PSH: (4.0, 3.0), HSP - 1.5: (0.8, 0.6)},
    "hsp.planet.1": {HSP: (1.0, 1.0)},
    "psh.input": {PSH: (5.0, 12.0), 413.0: (1.5, 2.0)},
    "psh.output": {PSH: (8.0, 6.0), PSH - HSP: (0.3, 0.4), 900.0: (20.0, 0.0)},
}

# rotor: speed [rad/s]
SPEEDS = {
    "lsp.ring": 1.6,
    "lsp.planet.1": -3.9,
    "lsp.planet.2": -3.7,
    "lsp.sun": -8.4,
    "hsp.carrier": -8.4,
    "hsp.planet.1": 11.6,
    "hsp.sun": -67.0,
    "psh.input": -67.0,
    "psh.output": 188.0,
    "motor": 1.6,
}


def time_axis() -> np.ndarray:
    return np.arange(int(DURATION * RATE)) / RATE


def transient(time: np.ndarray) -> np.ndarray:
    return np.where(time < STEADY - 0.5, np.cos(40.0 * time), 0.0)


def _forces(time: np.ndarray) -> dict[str, np.ndarray]:
    result = {}
    for group, (count, mean, amplitude, frequency) in FORCES.items():
        for number in range(1, max(count, 1) + 1):
            phase = (number - 1) / max(count, 1)
            wave = mean + amplitude * np.sin(2 * np.pi * (frequency * time + phase))
            result[f"{group}.{number}" if count else group] = wave + 2.0 * mean * transient(time)
    return result


def _phases(time: np.ndarray) -> np.ndarray:
    # Ring meshes run backwards: only the magnitude of the slope is the frequency.
    columns = []
    for group, (count, _, _, frequency) in FORCES.items():
        sign = -1.0 if "ring" in group else 1.0
        columns += [sign * frequency * time + 0.25 * number for number in range(max(count, 1))]
    return np.stack(columns, axis=1)


def _accelerations(time: np.ndarray, axis: int) -> np.ndarray:
    return np.stack(
        [
            50.0 * transient(time) + sum(pair[axis] * np.sin(2 * np.pi * f * time + axis) for f, pair in tones.items())
            for tones in TONES.values()
        ],
        axis=1,
    )


def make_dataset(pressure_angle: bool = False) -> xr.Dataset:
    time = time_axis()
    forces = _forces(time)
    ones = np.ones((time.size, 1))
    variables = {
        "mesh_force": (("time", "mesh"), np.stack(list(forces.values()), axis=1), "N"),
        "mesh_phase": (("time", "mesh"), _phases(time), "cycle"),
        "acceleration_x": (("time", "member"), _accelerations(time, 0), "m/s^2"),
        "acceleration_y": (("time", "member"), _accelerations(time, 1), "m/s^2"),
        "speed": (("time", "rotor"), ones * np.array(list(SPEEDS.values())), "rad/s"),
        "bearing_force_x": (("time", "bearing"), ones * 3.0, "N"),
        "bearing_force_y": (("time", "bearing"), ones * 4.0, "N"),
    }
    if pressure_angle:
        variables["pressure_angle"] = (("mesh",), np.full(len(forces), ALPHA), "rad")
    return xr.Dataset(
        {
            name: (dims, values, {"units": unit, "long_name": name.replace("_", " ")})
            for name, (dims, values, unit) in variables.items()
        },
        coords={
            "time": time,
            "mesh": list(forces),
            "member": list(TONES),
            "rotor": list(SPEEDS),
            "bearing": ["lsp.ring"],
        },
        attrs={"scene": "synthetic"},
    )
