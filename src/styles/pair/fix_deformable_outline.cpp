#include "styles/pair/fix_deformable_outline.h"

#include "styles/lammps_release.h"
#include "styles/pair/compute_deformable_outline.h"

#include "compute.h"
#include "error.h"
#include "modify.h"

#include <string>

using namespace LAMMPS_NS;
using namespace deformable;

FixDeformableOutline::FixDeformableOutline(LAMMPS *lmp, int narg, char **arg) : Fix(lmp, narg, arg)
{
  if (narg != 3)
    error->all(FLERR, "Fix deformable/outline has no arguments: use 'compute deformable/outline'");
  delete[] style;
  style = utils::strdup("draw/outline");    // see FixDeformableWall
  global_freq = 1;                          // at any step: dump image of 2026 asks
}

int FixDeformableOutline::image(int *&of_kind, double **&of_line)
{
  Compute *const outline = modify->get_compute_by_id(id);
  if (!outline || std::string(outline->style) != ComputeDeformableOutline::STYLE)
    error->all(FLERR,
               "Fix {0} deformable/outline draws a compute {0} deformable/outline: define one", id);
  outline->compute_local();
  const int size = outline->size_local_rows;
  kinds.assign(size, IMAGE_LINE);
  lines.resize(size);
  rows.resize(size);
  for (int k = 0; k < size; ++k) {
    const double *const row = outline->array_local[k];
    lines[k] = {image_color(row[1]), row[3], row[4], 0.0, row[5], row[6], 0.0};
    rows[k] = lines[k].data();
  }
  of_kind = kinds.data();
  of_line = rows.data();
  return size;
}
