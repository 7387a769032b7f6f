#pragma once

#include <Bnd_Box.hxx>
#include <TopoDS_Face.hxx>
#include <gp_Pnt.hxx>
#include <memory>
#include <optional>
#include <vector>

namespace vdb_offset::cad {

/// How a face lies on others.
struct Lying {
  enum class How { Apart, Partly, Wholly } how = How::Apart;
  std::size_t on = 0;  ///< the first of the others that it lies on
  gp_Pnt place;        ///< there, on both; millimetres
};

struct FacePlace;

/// Faces that others may lie on.
class Ground {
 public:
  /// What is nearer than `near_cad` lies on them.
  Ground(const std::vector<TopoDS_Face>& faces, double near_cad);
  ~Ground();
  Ground(const Ground&) = delete;
  Ground& operator=(const Ground&) = delete;

  /// Of places all over a face, on its edges too: wholly if all lie on some of the faces, partly if
  /// some within it do, turned as these are or against that. What touches along a line is apart.
  /// A part smaller than a twentieth of the face may be missed.
  Lying lying_of(const TopoDS_Face& face) const;
  /// The first of the others that one of the faces itself lies on, wholly, those left out aside.
  std::optional<std::size_t> under(std::size_t own, const std::vector<bool>& left_out) const;

 private:
  struct Piece;
  std::vector<std::size_t> near(const TopoDS_Face& face) const;
  int first_under(const FacePlace& place, const std::vector<std::size_t>& some) const;

  double near_cad_;
  std::vector<std::unique_ptr<Piece>> pieces_;
};

}  // namespace vdb_offset::cad
