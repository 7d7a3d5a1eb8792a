"""Hydra's basic sweeper, except that a job that cannot be composed does not stop the others."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

from hydra._internal.core_plugins.basic_sweeper import BasicSweeper
from hydra.core.override_parser.overrides_parser import OverridesParser
from hydra.core.utils import JobReturn
from hydra.errors import HydraException
from omegaconf.errors import OmegaConfBaseException


@dataclass
class SweepOutcome:
    """What became of the jobs of the last sweep."""

    returns: list[JobReturn] = field(default_factory=list)
    refused: list[tuple[str, Exception]] = field(default_factory=list)
    """(overrides of the job, why it could not be composed)"""

    def forget(self) -> None:
        """Nothing swept yet: one process may run the command line more than once."""
        self.returns.clear()
        self.refused.clear()


last_sweep = SweepOutcome()


class PatientSweeper(BasicSweeper):
    """Every combination of the values on the command line; those that do not compose are left out and kept aside."""

    def sweep(self, arguments: list[str]) -> Any:
        """Run the jobs; results go to `last_sweep` as well, because Hydra's entry point returns nothing."""
        assert self.hydra_context is not None
        assert self.launcher is not None
        last_sweep.forget()
        parser = OverridesParser.create(config_loader=self.hydra_context.config_loader)
        overrides = parser.parse_overrides([*self._parse_config(), *arguments])
        first = 0
        for batch in self.split_arguments(overrides, self.max_batch_size):
            jobs = [job for job in batch if self._composes(job)]
            if jobs:
                last_sweep.returns.extend(self.launcher.launch(jobs, initial_job_idx=first))
            first += len(jobs)
        return last_sweep.returns

    def _composes(self, job: Sequence[str]) -> bool:
        assert self.hydra_context is not None
        assert self.config is not None
        try:
            self.hydra_context.config_loader.load_sweep_config(self.config, list(job))
        except (HydraException, OmegaConfBaseException) as error:
            last_sweep.refused.append((" ".join(o for o in job if not o.startswith("hydra.mode=")), error))
            return False
        return True
