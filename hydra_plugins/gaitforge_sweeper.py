"""Where Hydra looks for sweepers; the sweeper itself is `gaitforge.cli.sweep`."""

# No postponed annotations here: Hydra runs a plugin before it is in sys.modules, where dataclass looks them up.
from dataclasses import dataclass

from hydra.core.config_store import ConfigStore

from gaitforge.cli.sweep import PatientSweeper


class GaitforgeSweeper(PatientSweeper):
    """Every combination of the values on the command line, those left out that do not compose."""


@dataclass
class GaitforgeSweeperConf:
    """Config of the sweeper."""

    _target_: str = "hydra_plugins.gaitforge_sweeper.GaitforgeSweeper"
    max_batch_size: int | None = None
    params: dict[str, str] | None = None


ConfigStore.instance().store(group="hydra/sweeper", name="gaitforge", node=GaitforgeSweeperConf, provider="gaitforge")
