#include "styles/pair/particle_results.h"

#include "laws/trigonometry.h"

#include <algorithm>
#include <cstring>

using namespace LAMMPS_NS;
using deformable::PI;

double *ParticleResults::extract(const char *name)
{
  const char *const *const names = dimension == 2 ? NAMES : NAMES_OF_SURFACE;
  const int size = dimension == 2 ? SIZE : SIZE_OF_SURFACE;
  for (int k = 0; k < size; ++k)
    if (std::strcmp(name, names[k]) == 0) {
      requested = true;
      return values[k].data();
    }
  return nullptr;
}

void ParticleResults::resize(std::size_t particles)
{
  for (std::vector<double> &v : values)
    if (v.size() < particles) v.resize(particles);
}

void ParticleResults::clear(std::size_t particles)
{
  for (std::vector<double> &v : values) std::fill_n(v.begin(), particles, 0.0);
}

void ParticleResults::store_shape(int i, double radius, int contacts,
                                  const deformable::Shape &shape, double pressure)
{
  int active = 0;
  double length = 0.0;
  for (int c = 0; c < contacts; ++c) {
    active += shape.contact[c].length != 0.0;
    length += shape.contact[c].length;
  }
  values[AREA][i] = PI * radius * radius - shape.area_deficit;
  values[PERIMETER][i] = 2.0 * PI * radius + shape.perimeter_excess;
  values[CONTACTS][i] = active;
  values[PRESSURE][i] = pressure;
  values[ARC_RADIUS][i] = shape.arc_radius;
  values[CONTACT_LENGTH][i] = length;
}

void ParticleResults::store_circle(int i, double radius, double pressure)
{
  values[AREA][i] = PI * radius * radius;
  values[PERIMETER][i] = 2.0 * PI * radius;
  values[CONTACTS][i] = values[CONTACT_LENGTH][i] = 0.0;
  values[PRESSURE][i] = pressure;
  values[ARC_RADIUS][i] = radius;
}

void ParticleResults::store_surface(int i, const Surface &surface)
{
  values[AREA][i] = surface.area;
  values[CONTACTS][i] = surface.contacts;
  values[PRESSURE][i] = surface.pressure;
  values[CONTACT_AREA][i] = surface.contact_area;
  values[LOAD][i] = surface.load;
}

double ParticleResults::bytes() const
{
  double sum = 0.0;
  for (const std::vector<double> &v : values)
    sum += static_cast<double>(v.capacity() * sizeof(double));
  return sum;
}
