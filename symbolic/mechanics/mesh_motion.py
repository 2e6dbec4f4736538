"""Mesh phases, stiffness and errors over them, and values of element parameters."""

from abc import abstractmethod

from ltcgear.generated.contract import BACK

from ..elements.base import Element
from .kinematics import Kinematics, Value
from .model import BASIS, ERROR, ERROR_RATE, LEVEL, PHASE, SLOPE, STIFFNESS, TURN, Instance, Phase, Profile


class MeshMotion(Kinematics):
    """Motion of the meshes for their elements: phases, and the quantities that vary with them."""

    @abstractmethod
    def level(self, mesh: str) -> Value:
        """Return the level of a mesh, 0 in single and 1 in double contact; zero if it has none."""

    @abstractmethod
    def one_profile(self, item: Profile, place: int, tau: Value) -> tuple[Value, Value]:
        """Return the value of a profile at a phase and its slope per cycle; it is the ``place``-th of its quantity."""

    def phase(self, mesh: str) -> Phase | None:
        """Return the phase of a mesh, None if it has none."""
        return next((phase for phase in self.model.phases if phase.name == mesh), None)

    def profile(self, mesh: str, quantity: str, tau: Value) -> tuple[Value, Value]:
        """Return a quantity of a mesh at a phase tau and its slope per cycle: the sum of its profiles."""
        value = slope = self.zero
        items = [item for item in self.model.profiles if (item.mesh, item.quantity) == (mesh, quantity)]
        for place, item in enumerate(items):
            one = self.one_profile(item, place, tau)
            value, slope = value + one[0], slope + one[1]
        return value, slope

    # --- phases

    def phase_of(self, mesh: str) -> Value:
        """Return the phase tau [cycles] of a mesh by the rigid motion."""
        phase = self.phase(mesh)
        if phase is None:
            return self.zero
        return self.keep(f"tau@{mesh}", mesh, self._rigid_cycles(phase) + self.number(phase.start, f"tau_0@{mesh}"))

    def phase_rate(self, mesh: str) -> Value:
        """Return the rate [1/s] of a mesh's phase."""
        phase = self.phase(mesh)
        if phase is None or phase.rate is None:
            return self.zero
        return self.number(phase.rate, f"nu@{mesh}") * self.speed

    def _rigid_cycles(self, phase: Phase) -> Value:
        """Return the tooth pitches [cycles] passed in the rigid motion."""
        if phase.rate is not None:
            return self.number(phase.rate, f"nu@{phase.name}") * self.phi
        if self.model.reference == "rest":
            return self.zero
        body = self.bodies[phase.gear]
        relative = self.ratio(body.ratio) - self.ratio(self.model.frames[body.frame])
        return self.number(phase.teeth, f"z_1@{phase.name}") / (2 * self.functions.pi) * relative * self.phi

    def gear_phase(self, phase: Phase, rolling: Value, tag: str) -> Value:
        """Return the phase [cycles] of gear 1's own motion from its full rolling angle in inertial axes."""
        teeth = self.number(phase.teeth, f"z_1{tag}") / (2 * self.functions.pi)
        own = self.number(phase.rolled, f"tau_0{tag}") + teeth * rolling
        return self._rigid_cycles(phase) + own if self.basis == "frame" else own

    # --- what varies with them

    def stiffness(self, mesh: str) -> tuple[Value, Value]:
        """Return the stiffness [N/m] of a mesh at its phase, and its slope per cycle."""
        value, slope = self.profile(mesh, "stiffness", self.phase_of(mesh))
        return self.keep(f"k@{mesh}", mesh, value), slope

    def followed(self, instance: Instance, tag: str, rolling: Value) -> dict[str, Value]:
        """Return a stiffness and its slope at the phase of gear 1's own motion."""
        mesh = instance.name.removesuffix(BACK)
        phase, owner = self.phase(mesh), tag.removeprefix("#")
        assert phase is not None
        tau = self.keep(f"tau{tag}", owner, self.gear_phase(phase, rolling, tag))
        value, slope = self.profile(mesh, "stiffness", tau)
        return {"k": self.keep(f"k{tag}", owner, value), "k_d": self.keep(f"k_d{tag}", owner, slope)}

    def error(self, instance: Instance) -> Value:
        """Return the error [m] of a mesh's element; it has the opposite sign on the other flank."""
        mesh, sign = instance.name.removesuffix(BACK), self._side(instance)
        tau = self.phase_of(mesh)
        error = self.keep(f"e@{mesh}", mesh, self.profile(mesh, "error", tau)[0])
        if instance.group != "mesh":  # friction sees in the plane where pins stand
            return sign * error
        turned, opening = (self.profile(mesh, quantity, tau)[0] for quantity in ("turned", "opening"))
        return sign * (error + turned) + opening

    def error_rate(self, instance: Instance) -> Value:
        """Return the rate [m/s] of that error."""
        mesh = instance.name.removesuffix(BACK)
        slope = self.profile(mesh, "error", self.phase_of(mesh))[1]
        return self._side(instance) * self.keep(f"e_d@{mesh}", mesh, slope * self.phase_rate(mesh))

    @staticmethod
    def _side(instance: Instance) -> int:
        """Return the sign of a flank."""
        return -1 if instance.name.endswith(BACK) else 1

    # --- parameters of elements

    def bound(self, instance: Instance, element: Element, tag: str) -> dict[str, Value]:
        """Return the values of an element's parameters, except a stiffness that follows the gear; see `followed`."""
        followed = (STIFFNESS, SLOPE) if SLOPE in instance.bind.values() else ()
        found = {
            symbol.name: self._bound(instance, instance.bind[symbol.name], symbol.name + tag)
            for symbol in element.parameters
            if instance.bind[symbol.name] not in followed
        }
        if self.basis == "inertial" and "e_x" in found:
            beta, _ = self.frame_turn(self.bodies[instance.bodies[-1]])
            found["e_x"], found["e_y"] = self.rotate(beta, found["e_x"], found["e_y"])
        return found

    def _bound(self, instance: Instance, name: str, letter: str) -> Value:
        """Return the value bound to a parameter of an element."""
        mesh = instance.name.removesuffix(BACK)
        if name in (TURN, BASIS):
            turns = (name == BASIS) == (self.basis == "frame")
            return self.frame_turn(self.bodies[instance.bodies[-1]])[0] if turns else self.zero
        if name == LEVEL:
            return self.level(mesh)
        if name == PHASE:
            return self.phase_of(mesh)
        if name == STIFFNESS:
            return self.stiffness(mesh)[0]
        if name == ERROR:
            return self.error(instance)
        if name == ERROR_RATE:
            return self.error_rate(instance)
        return self.number(name, letter)
