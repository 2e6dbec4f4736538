"""The stage by Exudyn, of its own objects: bodies, spring-dampers, and meshes as expressions it evaluates in C++.

Exudyn has no involute mesh between bodies that shift. Each mesh is an ``ObjectGenericODE2`` without mass on the nodes
of its two gears, whose force is a *symbolic* user function: recorded once, evaluated without Python. Where gears only
turn, a connector of its own is a mesh. Angles are counted from the rigid motion, positions from the nominal ones.
"""

from time import perf_counter
from typing import Any

import exudyn as exu
import numpy as np
from exudyn import advancedUtilities, itemInterface
from exudyn import symbolic as sym
from numpy.typing import NDArray

from .rig import RATE, T_END, Rig
from .stage import PLANETS

Vector = NDArray[np.float64]
SOLVERS: dict[str, tuple[float, ...]] = {"RK44": (1, 2, 4, 8), "RK67": (1, 2, 4), "TrapezoidalIndex2": (8, 32, 64)}
"""Exudyn's solvers, and the steps between two samples to be tried."""
FORCE = "ObjectGenericODE2,forceUserFunction"


def mesh_force(rig: Rig, name: str, number: int) -> Any:  # noqa: ANN401
    """Write the involute law of a mesh as a user function: what acts on body 1 and planet, from left to right."""
    v, key = rig.values, f"lsp.{name}"
    r1, r2, s, inv0 = (v[f"{key}.{n}"] for n in ("base_radius_1", "base_radius_2", "flank", "inv_alpha_0"))
    k, damping = v[f"{key}.stiffness"], v[f"{key}.damping"]
    x0, y0 = (v[f"lsp.planet.{number}.{axis}_0"] for axis in "xy")
    ex, ey = np.array([x0, y0]) / np.hypot(x0, y0)
    turns, sigma = (True, 1.0) if name == "sun_planet" else (False, -1.0)
    c, two = r1 + sigma * r2, 3 if turns else 2

    def force(mbs: Any, t: Any, item: Any, q: Any, q_t: Any) -> Any:  # noqa: ANN401
        dx, dy = x0 + (q[two] - q[0]), y0 + (q[two + 1] - q[1])
        square = dx * dx + dy * dy
        h = sym.sqrt(square - c * c)
        turned = sym.atan((ex * dy - ey * dx) / (ex * dx + ey * dy))
        w = sigma * r2 * q[two + 2] - c * turned + (r1 * q[2] if turns else 0.0)
        delta = s * w - sigma * (h - c * (sym.atan(h / c) + inv0))
        nx, ny = (sigma * h * dx - s * c * dy) / square, (sigma * h * dy + s * c * dx) / square
        # What 1 N does; its product with the rates is the speed at which the flanks part.
        unit = sym.Vector([-nx, -ny, *([-s * r1] if turns else []), nx, ny, -sigma * s * r2])
        return (k * delta - damping * (unit * q_t)) * unit

    return force


def record(mbs: Any, function: Any, size: int) -> Any:  # noqa: ANN401
    """Record a user function as Exudyn's expression; its own recorder knows no vectors of free length."""
    sym.SetRecording(True)
    given = [mbs, sym.Real("t", 0.0), sym.Real("itemNumber", 0)]
    given += [sym.Vector(name, [0.1] * size) for name in ("q", "q_t")]
    value = function(*given)
    sym.SetRecording(False)
    kinds = advancedUtilities.userFunctionArgsDict[FORCE]
    recorded = {"functionName": function.__name__, "argList": given, "argTypeList": kinds[0]}
    recorded |= {"returnValue": value, "returnType": kinds[2][0]}
    found = sym.UserFunction()
    found.SetUserFunctionFromDict(mbs, recorded, "forceUserFunction", None, "ObjectGenericODE2")
    return found, recorded


class System:
    """A stage as a system of Exudyn, with its states in our order; how it is built, the derived ones say."""

    def __init__(self, rig: Rig) -> None:
        self.rig = rig
        self.kept: list[Any] = []
        self.nodes: dict[str, Any] = {}
        exu.SetWriteToConsole(False)  # it warns on stdout of memory that expressions take
        self.container = exu.SystemContainer()
        self.mbs = self.container.AddSystem()
        self.build()
        kinds, options = exu.OutputVariableType, {"storeInternal": True, "writeToFile": False}
        self.sensors = [
            self.mbs.AddSensor(itemInterface.SensorNode(nodeNumber=node, outputVariableType=kind, **options))
            for kind in (kinds.Coordinates, kinds.Coordinates_t)
            for node in self.nodes.values()
        ]
        self.mbs.Assemble()

    def build(self) -> None:
        """Add all nodes, bodies, connectors and loads."""
        raise NotImplementedError

    def pull(self, name: str, coordinate: int) -> None:
        """Put the torque on a coordinate of a node."""
        marker = self.coordinate(self.nodes[name], coordinate)
        load = self.rig.values["loads.sun.torque"]
        self.load = self.mbs.AddLoad(itemInterface.LoadCoordinate(markerNumber=marker, load=load))

    def coordinate(self, node: Any, coordinate: int = 0) -> Any:  # noqa: ANN401
        """Mark a coordinate of a node."""
        return self.mbs.AddMarker(itemInterface.MarkerNodeCoordinate(nodeNumber=node, coordinate=coordinate))

    def __call__(self, x: Vector, levels: Vector) -> Vector:
        """Return our x', by Exudyn's forces and mass matrix; a mesh's force stands on the right there."""
        q, u = np.split(x[1:], 2)
        solver, settings = exu.MainSolverImplicitSecondOrder(), exu.SimulationSettings()
        settings.solution.file.write = False
        solver.InitializeSolver(self.mbs, settings)
        self.mbs.systemData.SetODE2Coordinates(q)
        self.mbs.systemData.SetODE2Coordinates_t(u)
        solver.ComputeMassMatrix(self.mbs)
        solver.ComputeODE2RHS(self.mbs)
        force, mass = np.array(solver.GetSystemResidual())[: len(q)], np.array(solver.GetSystemMassMatrix())
        solver.FinalizeSolver(self.mbs, settings)
        rates = np.linalg.solve(mass[: len(q), : len(q)], force)
        return np.concatenate([[self.rig.values["reference.speed"]], u, rates])

    def run(self, solver: str, substeps: int, torque: float) -> tuple[Vector, float]:
        """Run from the equilibrium under a torque [N m]; return our states at all samples and the seconds it took."""
        samples, start = round(T_END * RATE), self.rig.at.x[1 : 1 + len(self.rig.at.x) // 2]
        settings = exu.SimulationSettings()
        steps = settings.timeIntegration
        steps.numberOfSteps, steps.endTime = samples * substeps, T_END
        steps.automaticStepSize = steps.adaptiveStep = False
        settings.solution.file.write = False
        settings.solutionSettings.sensorsWritePeriod = 1 / RATE
        self.mbs.SetLoadParameter(self.load, "load", torque)
        data = self.mbs.systemData
        data.SetODE2Coordinates(start, configuration=exu.ConfigurationType.Initial)
        data.SetODE2Coordinates_t(np.zeros(len(start)), configuration=exu.ConfigurationType.Initial)
        clock = perf_counter()
        self.mbs.SolveDynamic(settings, solverType=getattr(exu.DynamicSolverType, solver))
        seconds = perf_counter() - clock
        stored = [self.mbs.GetSensorStoredData(sensor) for sensor in self.sensors]
        times = stored[0][:, 0]
        if len(times) != samples + 1 or abs(times - np.arange(samples + 1) / RATE).max() > 1e-9:
            raise RuntimeError(f"Exudyn has stored {len(times)} samples, not {samples + 1}")
        angle = self.rig.values["reference.speed"] * times
        return np.column_stack([angle, *(columns[:, 1:] for columns in stored)]), seconds


class Lateral(System):
    """The stage whose members shift and turn."""

    def build(self) -> None:
        """Add bodies, then meshes."""
        self.ground = self.mbs.AddObject(itemInterface.ObjectGround())
        self._add_bodies()
        self._add_meshes()

    def _add_bodies(self) -> None:
        """Add ring, sun and planets with their bearings, pins and the torque."""
        v, items = self.rig.values, itemInterface
        self.nodes["lsp.ring"] = self.mbs.AddNode(items.NodePoint2D())
        body = self.mbs.AddObject(items.ObjectMassPoint2D(mass=v["lsp.ring.mass"], nodeNumber=self.nodes["lsp.ring"]))
        self._hold(body, "lsp.ring.bearing", [0, 0, 0])
        for name in ("lsp.sun", *(f"lsp.planet.{i}" for i in range(1, PLANETS + 1))):
            kind, place = name.rstrip(".1234"), [v.get(f"{name}.{axis}_0", 0.0) for axis in "xy"]
            self.nodes[name] = self.mbs.AddNode(items.NodeRigidBody2D(referenceCoordinates=[*place, 0.0]))
            given = {"mass": v[f"{kind}.mass"], "inertia": v[f"{kind}.inertia"], "nodeNumber": self.nodes[name]}
            body = self.mbs.AddObject(items.ObjectRigidBody2D(**given))
            if kind == "lsp.planet":
                self._hold(body, "lsp.pin", [*place, 0.0])
        self.pull("lsp.sun", 2)

    def _hold(self, body: Any, name: str, place: list[float]) -> None:  # noqa: ANN401
        """Hold a body at a place of the housing by a spring and a damper."""
        v, items = self.rig.values, itemInterface
        markers = [
            self.mbs.AddMarker(items.MarkerBodyPosition(bodyNumber=number, localPosition=at))
            for number, at in ((self.ground, place), (body, [0, 0, 0]))
        ]
        k, c = ([v[f"{name}.{key}"]] * 2 + [0.0] for key in ("stiffness", "damping"))
        self.mbs.AddObject(items.ObjectConnectorCartesianSpringDamper(markerNumbers=markers, stiffness=k, damping=c))

    def _add_meshes(self) -> None:
        """Add the meshes."""
        for i in range(1, PLANETS + 1):
            for gear, name, size in (("lsp.sun", "sun_planet", 6), ("lsp.ring", "ring_planet", 5)):
                function, recorded = record(self.mbs, mesh_force(self.rig, name, i), size)
                self.kept += [function, recorded]  # the expressions must outlive the system
                numbers = [self.nodes[gear], self.nodes[f"lsp.planet.{i}"]]
                self.mbs.AddObject(
                    itemInterface.ObjectGenericODE2(
                        nodeNumbers=numbers, massMatrix=np.zeros((size, size)), forceUserFunction=function
                    )
                )


class Torsional(System):
    """The stage whose members only turn, of nothing but compiled connectors: a mesh is one with two factors."""

    def build(self) -> None:
        """Add rotors, then meshes, those of the held ring against the ground."""
        v, items = self.rig.values, itemInterface
        ground = self.mbs.AddNode(items.NodePointGround())
        for name in ("lsp.sun", *(f"lsp.planet.{i}" for i in range(1, PLANETS + 1))):
            self.nodes[name] = self.mbs.AddNode(items.Node1D(referenceCoordinates=[0.0]))
            inertia = v[f"{name.rstrip('.1234')}.inertia"]
            self.mbs.AddObject(items.ObjectRotationalMass1D(inertia=inertia, nodeNumber=self.nodes[name]))
        for i in range(1, PLANETS + 1):
            for key, sigma, node in (("sun_planet", 1.0, self.nodes["lsp.sun"]), ("ring_planet", -1.0, ground)):
                law = f"lsp.{key}"
                markers = [self.coordinate(one) for one in (node, self.nodes[f"lsp.planet.{i}"])]
                factors = {"factor0": -v[f"{law}.base_radius_1"], "factor1": sigma * v[f"{law}.base_radius_2"]}
                given = {"stiffness": v[f"{law}.stiffness"], "damping": v[f"{law}.damping"]}
                self.mbs.AddObject(
                    items.ObjectConnectorCoordinateSpringDamperExt(markerNumbers=markers, **factors, **given)
                )
        self.pull("lsp.sun", 0)
