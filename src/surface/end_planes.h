#pragma once

#include <cstddef>
#include <set>
#include <string>
#include <vector>

#include "surface/cut_faces.h"
#include "surface/find_boundaries.h"
#include "surface/plane_finder.h"

namespace vdb_offset {

/// "symmetry", then "symmetry 2": the first that is not used yet; used from then on.
std::string free_name(std::set<std::string>& used, const std::string& name);

/// Planes that a surface ends on, added one after the other to the boundaries of `ends`.
class EndPlanes {
 public:
  EndPlanes(const OpenSurface& surface, PlaneFinder& finder, std::set<std::string>& used,
            Ends& ends)
      : surface_(surface), finder_(finder), used_(used), ends_(ends) {}

  /// Those that are named. One given several times is shared: each name takes the part that its
  /// point is nearest to, `rest` all that is left. Throws InputError: see SurfaceOptions.
  void add_named(const std::vector<NamedPlane>& planes);
  /// Those that the edges that are left lie on: openings whose planes the wall passes elsewhere
  /// first, as two edges of such may well lie in a plane that the whole wall is behind.
  void find();
  /// Names for all, and nodes of free edges that lie on the planes, for `ends`.
  void finish();

 private:
  /// One of `ends.boundaries`, a plane that bounds all of the domain.
  struct Added {
    std::size_t boundary;
    std::vector<std::size_t> edges;
    double nearest_world = 0;  // of those beside it, where none lies on a plane that is given
  };
  /// One that is given without a name, or local; no kind: as the edges on it say.
  struct Unnamed {
    std::size_t boundary;
    std::string kind;
  };
  struct Found {
    Plane plane;
    std::vector<std::size_t> edges;
    bool is_whole;  // no boundary there is in this plane
  };

  bool is_one(const Plane& a, const Plane& b) const;
  bool cuts(const Plane& plane) const;
  void add(const std::string& name, const Plane& plane, const std::vector<std::size_t>& edges);
  bool add_local(const std::string& name, const Plane& plane,
                 const std::vector<std::size_t>& edges);
  std::string near_miss(const Plane& plane) const;
  std::string farthest_beyond(const Plane& plane) const;
  void add_one(const NamedPlane& named);
  void add_shared(const std::vector<NamedPlane>& names);
  std::vector<struct PlanePart> parts_of(Plane& plane, bool is_local) const;
  std::vector<struct Opening> openings_ahead() const;
  std::vector<std::size_t> openings_on(Plane& plane) const;
  void find_local();
  void find_global();
  std::vector<CutPlane> cut_planes() const;
  std::string kind_of(const Plane& plane, const std::vector<struct PlanePart>& parts,
                      const std::vector<CutPlane>& planes) const;
  void add_found();
  void note_missed(std::size_t given);
  void mark() const;
  bool has_mark(int node, const Plane& plane) const;
  std::size_t nearest(int node, const Plane& plane) const;

  const OpenSurface& surface_;
  PlaneFinder& finder_;
  std::set<std::string>& used_;
  Ends& ends_;
  std::vector<Added> added_;
  std::vector<Unnamed> unnamed_;
  std::vector<Found> found_;
};

}  // namespace vdb_offset
