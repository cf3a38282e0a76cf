"""Second derivatives of the energy of a state of droplets."""

from __future__ import annotations

import numpy as np

from ..common.errors import ParameterError
from ..core import droplet_blocks
from ..model.droplet import Droplet
from ..model.packing import Packing
from .droplet_contacts import DropletTable
from .hessian import Hessian
from .linear_response import LinearResponse
from .sides import bearing, between, by_centers, by_lines, by_strains, other_sides

# Local variables of a side, the vector and the shift of its facet; how the shift is seen from the
# other side; and the part of a change of the distance that a facet takes.
_VARIABLES, _OTHER_SIDE, _SHARE = 4, (-1.0,), 0.5


class DropletResponse(LinearResponse):
    """Linear response of a `DropletState`."""

    packing: Packing
    law: Droplet
    contact_table: DropletTable

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy of droplets, see `SoftResponse.hessian`.

        Raises:
            ParameterError: droplets touch walls; or the compliance of one is singular, far beyond
                the model.
        """
        packing, table = self.packing, self.contact_table
        if (table["j"] < 0).any():
            raise ParameterError(
                "second derivatives of droplets do not know walls: take a state of a periodic box "
                "without them"
            )
        if not rattlers:
            force = table["force"]
            kept = bearing(table["i"], table["j"], force, len(packing), packing.dimension)
            table = table[kept | kept[other_sides(table)]]
        sides = between(table["i"], table["j"], table["distance"][:, None] * table["normal"])
        tension = self.law.species_parameters(packing.radii).of(packing.species).tension
        number = np.bincount(sides.i, minlength=len(packing))
        droplets = np.column_stack([number, packing.radius, tension])
        rows = [sides.vector, sides.turn, np.full(len(table), _SHARE), table["force"]]
        try:
            blocks = droplet_blocks(droplets, np.column_stack(rows))
        except ValueError as error:
            raise ParameterError(str(error)) from None
        from scipy.sparse import hstack

        facets = by_lines(other_sides(table), _VARIABLES, _OTHER_SIDE)
        chain = hstack([by_centers(sides, len(packing), _VARIABLES), *facets], format="csr")
        return Hessian(packing, blocks, chain, by_strains(sides, _VARIABLES))
