// A wall of any outline: a chain of segments in the plane, a surface of triangles in space. It may be open, and lies at rest here:
// Scene moves it.
//
// A particle touches the surface wherever the distance of the surface from its center has a local minimum. With
//   s = m.(x - p),   m: along an element, across its side at p, from the side inward
// that is the foot inside of an element, where s > 0 at all of its sides; and a side (in the plane a corner, in space an edge), where
// s <= 0 for all elements that meet in it. In space it is also a corner, where e.(x - p) <= 0 for all edges e away from it.
// Elements and sides share these numbers, so that the joint of two elements in one plane has one contact, to the last bit.
//
// Two elements that make a corner around the particle go on beyond it as long as the other one has a contact: each is a plane, as
// faces of a container are, and forces have no step. If they turn by less than SMOOTH, or are narrow facets and turn by less than
// BLUNT, only the nearest one counts: then the energy has none.

#ifndef DEFORMABLE_MESH_H
#define DEFORMABLE_MESH_H

#include "geometry/surface.h"

#include <string>
#include <vector>

namespace deformable {

class Mesh {
 public:
  // `corners`: `dimension` of each element. Returns what is wrong, or nothing; `row`: what an element is called. A container must
  // be closed. Particles are on both sides of a surface that is open.
  std::string build(int dimension, const std::vector<Vector3> &corners, bool is_container,
                    const std::string &row);

  struct Contact {
    int feature;    // for memories: the same one as long as the contact rolls on over smooth joints and around convex ones
    int part;       // where it is: an element, a side or a corner
    int element;    // there, which faces the center most
    SurfacePoint point;
  };
  // All contacts within the cutoff, the nearest one first. If a closed surface has the center on its wrong side, its height is
  // negative.
  void find_contacts(const Vector3 &x, double cutoff, std::vector<Contact> &) const;
  // The nearest one at any distance.
  Contact nearest(const Vector3 &x) const;
  // As seen from the element, side or corner of a contact, which may have moved a little.
  SurfacePoint point_of(int part, const Vector3 &x) const;

  int features() const { return first_part + parts(); }
  Vector3 low{}, high{};                        // of all corners
  double volume() const { return enclosed; }    // or area, of all closed parts
  std::vector<Vector3> edges() const;           // in space, but where it is flat: both ends of each
  double bytes() const;

 private:
  struct Element {
    int corner[3], side[3];
    Vector3 in[3];    // m of its sides
    Vector3 n, at;    // unit normal; a corner
    int key
        [2]
        [2];    // the feature, if blunt joints are corners and if they are smooth, of the front, where n points, and the back
    double width;    // of its plane
    int plane;       // elements in one plane that are joined have the same one
    int solid;       // 1: particles must be in front; -1: behind; 0: where they are
  };
  // Where elements meet; in space with both of its ends.
  struct Side {
    int corner[2];
    Vector3 along;
    std::vector<int> elements;
    std::vector<int> place;    // which of their sides it is
    bool is_flat = false;
    // of two elements: whether both fronts are on different sides of the surface; whether they make a concave corner, and a sharp
    // one, around what is in front of the first one, and around what is behind it
    bool is_turned = false, is_blunt = false;
    bool is_concave[2] = {false, false}, is_sharp[2] = {false, false};
    Vector3 away{};    // from the solid, the sum over its elements
  };
  struct Corner {
    Vector3 x;
    std::vector<int> sides, elements;
    bool is_flat = false;
    bool is_straight = false;    // two edges make one line, along
    Vector3 along{}, away{};
  };
  struct Node {    // of a tree of boxes around elements
    Vector3 low, high;
    int begin, end, second;    // elements; of a leaf there is no second child
  };
  struct Near {
    int part;
    Vector3 foot;
    double square;
  };

  int dimension = 2;
  std::vector<Element> elements;
  std::vector<Side> sides;
  std::vector<Corner> corners;
  std::vector<int> order;    // of elements, in the leaves
  std::vector<Node> tree;
  int first_part = 0;    // of the features
  double enclosed = 0.0;
  bool has_sharp = false;

  int parts() const
  {
    const std::size_t n = elements.size() + sides.size() + (dimension == 3 ? corners.size() : 0);
    return static_cast<int>(n);
  }
  int part_of_side(int side) const { return static_cast<int>(elements.size()) + side; }
  int part_of_corner(int corner) const
  {
    return part_of_side(static_cast<int>(sides.size())) + corner;
  }

  double inside(const Element &e, int k, const Vector3 &x) const
  {
    return dot(e.in[k], x - corners[sides[e.side[k]].corner[0]].x);
  }
  // Along an edge, from each of its ends.
  double beyond(const Side &side, int end, const Vector3 &x) const
  {
    return (end == 0 ? 1.0 : -1.0) * dot(side.along, x - corners[side.corner[end]].x);
  }
  bool is_front(const Element &e, const Vector3 &x) const { return dot(e.n, x - e.at) >= 0.0; }

  std::vector<int> merge(const std::vector<Vector3> &points);
  std::string read_elements(const std::vector<Vector3> &, const std::string &row);
  double size_of(const Element &) const;
  void join();
  std::string find_solid(bool is_container, const std::string &row);
  void look_at_corners();
  void grow_tree(int begin, int end);
  template <class Visitor> void visit(const Vector3 &x, double &square, Visitor &&) const;
  Near nearest_on(int element, const Vector3 &x) const;
  bool is_minimum(const Side &, const Vector3 &x) const;
  bool is_minimum(int corner, const Vector3 &x) const;
  Contact contact_at(int part, const Vector3 &x) const;
  bool is_pit(const Corner &, const Vector3 &x) const;
  void go_on(int element, const Vector3 &x, double cutoff, std::vector<Contact> &) const;
};

}    // namespace deformable

#endif
