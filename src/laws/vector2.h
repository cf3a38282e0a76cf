// Vectors in the plane, with the operations of vector3.h. There a spin, and a cross product, are numbers: the components along z.

#ifndef DEFORMABLE_VECTOR2_H
#define DEFORMABLE_VECTOR2_H

namespace deformable {

struct Vector2 {
  double x, y;
};

inline Vector2 operator+(const Vector2 &a, const Vector2 &b)
{
  return {a.x + b.x, a.y + b.y};
}
inline Vector2 operator-(const Vector2 &a, const Vector2 &b)
{
  return {a.x - b.x, a.y - b.y};
}
inline Vector2 operator-(const Vector2 &a)
{
  return {-a.x, -a.y};
}
inline Vector2 operator*(double s, const Vector2 &a)
{
  return {s * a.x, s * a.y};
}
inline double dot(const Vector2 &a, const Vector2 &b)
{
  return a.x * b.x + a.y * b.y;
}
inline double dot(double a, double b)
{
  return a * b;
}
inline double cross(const Vector2 &a, const Vector2 &b)
{
  return a.x * b.y - a.y * b.x;
}
inline Vector2 cross(double spin, const Vector2 &a)
{
  return {-spin * a.y, spin * a.x};
}

}    // namespace deformable

#endif
