"""Second derivatives of the energy of a state of the ring laws."""

from __future__ import annotations

from ..common.errors import ParameterError
from ..model.friction import Friction
from ..model.laws import Law
from ..model.packing import Packing
from .contact_table import ContactTable
from .hessian import Hessian
from .linear_response import LinearResponse
from .lines import Floats, balanced, lines_of, rattler_contacts
from .sides import Sides


class RingResponse(LinearResponse):
    """Linear response of a `State`."""

    packing: Packing
    law: Law
    contact_table: ContactTable
    unsaved: str
    friction: Friction | None

    def hessian(self, rattlers: bool = True) -> Hessian:
        """Second derivatives of the energy of the ring laws, see `SoftResponse.hessian`.

        Raises:
            ParameterError: the law is `Sector`, particles stick or rub, walls were given to `lmp`,
                or a line is held at the largest tilt.
        """
        if self.unsaved:
            raise ParameterError(
                f"second derivatives do not know the {self.unsaved} that were given to lmp"
            )
        if self.friction:
            raise ParameterError("friction has no energy, and so no second derivatives of one")
        lines = lines_of(self.packing, self.law, self.contact_table, rattlers)
        return balanced(lines).hessian()

    def rattler_contacts(self) -> tuple[Sides, Floats]:
        """Contacts that `hessian(rattlers=False)` leaves out, and lengths by which they open.

        Returns:
            Sides of S contacts, and distances (S,) by which they are to become longer [length].
        """
        return rattler_contacts(self.packing, self.contact_table)
