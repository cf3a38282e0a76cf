#include "styles/friction/box_rate.h"

#include "domain.h"
#include "fix.h"
#include "modify.h"
#include "update.h"

#include <algorithm>

namespace deformable {

bool BoxRate::Box::operator==(const Box &other) const
{
  return std::equal(low, low + 3, other.low) && std::equal(h, h + 6, other.h);
}

BoxRate::Box BoxRate::present() const
{
  Box box{};
  std::copy_n(domain->boxlo, 3, box.low);
  std::copy_n(domain->h, 6, box.h);
  return box;
}

void BoxRate::remember()
{
  before = present();
  step = update->ntimestep;
}

void BoxRate::end_run()
{
  at_end = present();
}

// A run that goes on where the last one ended knows the change of the box after its last step.
void BoxRate::begin_run()
{
  if (step != update->ntimestep || !(present() == at_end)) remember();
}

/* ----------------------------------------------------------------------
   Of each fix deform the sides and tilts that it changes. A box that it has not
   changed yet keeps LAMMPS' rates.
------------------------------------------------------------------------- */

void BoxRate::measure()
{
  if (!domain->deform_vremap || step != update->ntimestep - 1) return;
  const int changes[] = {Fix::BOX_CHANGE_X,  Fix::BOX_CHANGE_Y,  Fix::BOX_CHANGE_Z,
                         Fix::BOX_CHANGE_YZ, Fix::BOX_CHANGE_XZ, Fix::BOX_CHANGE_XY};
  const Box now = present();
  if (now == before) return;
  for (const Fix *fix : modify->get_fix_by_style("^deform")) {
    if (step % fix->nevery != 0) continue;
    const double time = fix->nevery * update->dt;
    for (int k = 0; k < 6; ++k) {
      if (!(fix->box_change & changes[k])) continue;
      domain->h_rate[k] = (now.h[k] - before.h[k]) / time;
      if (k < 3) domain->h_ratelo[k] = (now.low[k] - before.low[k]) / time;
    }
  }
}

}    // namespace deformable
