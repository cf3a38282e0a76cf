// Memory that vectors hold.

#ifndef DEFORMABLE_VECTOR_BYTES_H
#define DEFORMABLE_VECTOR_BYTES_H

namespace LAMMPS_NS {

template <class... Vector> double bytes_of(const Vector &...vector)
{
  return (static_cast<double>(vector.capacity() * sizeof(typename Vector::value_type)) + ... + 0.0);
}

}    // namespace LAMMPS_NS

#endif
