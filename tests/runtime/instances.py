"""Instances of FMUs in FMPy."""

import fmpy
import numpy as np
from fmpy.fmi2 import FMU2Slave, fmi2CallbackFunctions, fmi2CallbackLoggerTYPE
from fmpy.fmi3 import FMU3Model

from .rattling import RATE

STEP = 1 / RATE
DISCARD, ERROR = 2, 3
FORCES = {"pair.mesh.mesh_force": "pair.mesh", "pair.mesh.back.mesh_force": "pair.mesh.back"}


class Instance:
    """An instance of an FMU, variables by name."""

    def __init__(self, path, unzipped):
        self.description = fmpy.read_model_description(path)
        self.reference = {v.name: v.valueReference for v in self.description.modelVariables}
        kinds = {"2.0": (FMU2Slave, "coSimulation"), "3.0": (FMU3Model, "modelExchange")}
        kind, part = kinds[self.description.fmiVersion]
        self.two = kind is FMU2Slave
        names = {"guid": self.description.guid, "unzipDirectory": str(unzipped), "instanceName": "gears"}
        self.fmu = kind(modelIdentifier=getattr(self.description, part).modelIdentifier, **names)
        self.said = []
        self.instantiate()

    def instantiate(self):
        """Make it."""
        if self.two:

            def log(component, name, status, category, message):
                self.said.append((status, message.decode()))

            self.logger = fmi2CallbackLoggerTYPE(log)
            self.callbacks = fmi2CallbackFunctions()
            self.callbacks.logger = self.logger
            self.fmu.instantiate(callbacks=self.callbacks)
        else:
            self.fmu.instantiate()

    def initialise(self, tolerance=1e-9, **values):
        """Set values and find the equilibrium."""
        if self.two:
            self.fmu.setupExperiment(tolerance=tolerance)
        else:
            self.fmu.enterInitializationMode(tolerance=tolerance)
        for name, value in values.items():
            self[name] = value
        if self.two:
            self.fmu.enterInitializationMode()
        self.fmu.exitInitializationMode()
        return self

    def __getitem__(self, name):
        get = self.fmu.getReal if self.two else self.fmu.getFloat64
        return get([self.reference[name]])[0]

    def __setitem__(self, name, value):
        setter = self.fmu.setReal if self.two else self.fmu.setFloat64
        setter([self.reference[name]], [value])

    def step(self, number, count=1):
        """Go on over communication steps from one on; return the mesh forces after each."""
        found = []
        for k in range(number, number + count):
            self.fmu.doStep(k * STEP, STEP)
            found.append([self[name] for name in FORCES])
        return np.array(found)

    def state(self, what, *values):
        """Call a function of FMU states, whose names FMPy writes differently in both versions."""
        found = {name.lower(): name for name in dir(self.fmu)}
        return getattr(self.fmu, found[f"{what}fmustate"])(*values)

    def close(self):
        """Free it."""
        self.fmu.freeInstance()


def set_states(instance, x):
    """Set the states of an instance for model exchange."""
    values = (fmpy.fmi3.fmi3Float64 * len(x))(*x)
    instance.fmu.setContinuousStates(values, len(x))
