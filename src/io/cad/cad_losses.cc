// What a transfer has no result for, as OpenCASCADE keeps account of it.

#include "io/cad/cad_losses.h"

#include <fmt/format.h>

#include <IGESBasic_SingularSubfigure.hxx>
#include <IGESBasic_SubfigureDef.hxx>
#include <IGESData_IGESEntity.hxx>
#include <IGESData_UndefinedEntity.hxx>
#include <Interface_Check.hxx>
#include <Interface_InterfaceModel.hxx>
#include <StepShape_ClosedShell.hxx>
#include <StepShape_ConnectedFaceSet.hxx>
#include <StepShape_Face.hxx>
#include <TCollection_HAsciiString.hxx>
#include <TopExp_Explorer.hxx>
#include <TransferBRep.hxx>
#include <Transfer_TransientProcess.hxx>
#include <XSControl_TransferReader.hxx>
#include <XSControl_WorkSession.hxx>

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <string_view>

namespace vdb_offset::cad {
namespace {

class Losses {
 public:
  explicit Losses(const Handle(XSControl_WorkSession) & session)
      : model_(session->Model()), process_(session->TransferReader()->TransientProcess()) {}

  std::vector<std::string> all() {
    for (int n = 1; n <= model_->NbEntities(); ++n) {
      const Handle(Standard_Transient) entity = model_->Value(n);
      const auto set = Handle(StepShape_ConnectedFaceSet)::DownCast(entity);
      if (!set.IsNull()) check_set(set);
      const auto iges = Handle(IGESData_IGESEntity)::DownCast(entity);
      if (!iges.IsNull()) check_iges(iges);
    }
    constexpr std::size_t kShown = 5;
    if (words_.size() > kShown) {
      const std::size_t hidden = words_.size() - kShown;
      words_.resize(kShown);
      words_.push_back(fmt::format("{} more are left out like these", hidden));
    }
    return words_;
  }

 private:
  std::string label(const Handle(Standard_Transient) & entity) const {
    return model_->StringLabel(entity)->ToCString();
  }

  /// What OpenCASCADE says of an entity as it is in the file; empty: nothing.
  std::string said_of(const Handle(Standard_Transient) & entity) const {
    const int number = model_->Number(entity);
    const Handle(Interface_Check) check =
        number > 0 ? model_->Check(number, true) : new Interface_Check();
    return check->NbFails() == 0 ? std::string() : fmt::format(" ({})", check->CFail(1));
  }

  bool has_face(const Handle(Standard_Transient) & entity) const {
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process_, entity);
    return !shape.IsNull() && TopExp_Explorer(shape, TopAbs_FACE).More();
  }

  void check_set(const Handle(StepShape_ConnectedFaceSet) & set) {
    for (int f = 1; f <= set->NbCfsFaces(); ++f) {
      const Handle(StepShape_Face) face = set->CfsFacesValue(f);
      if (face.IsNull()) {
        words_.push_back(
            fmt::format("face {} of {} in the list of {} is none that can be read{}, "
                        "and is left out",
                        f, set->NbCfsFaces(), label(set), said_of(set)));
      } else if (!has_face(face)) {
        lose(face, "face");
      }
    }
  }

  void check_iges(const Handle(IGESData_IGESEntity) & entity) {
    if (entity->BlankStatus() != 0) return;
    const std::string_view word = is_instance_of_shape(entity) ? "instance" : word_of(*entity);
    if (!word.empty() && !has_face(entity)) lose(entity, word);
  }

  /// Of faces, and of surfaces and solids that stand for themselves (those that are parts of others
  /// are physically dependent), by their types in IGES 5.3; of what cannot be read there, too.
  /// Empty: of none.
  std::string_view word_of(const IGESData_IGESEntity& entity) const {
    constexpr std::array kFaces{143, 144, 510};
    constexpr std::array kSurfaces{114, 118, 120, 122, 128, 140, 190, 192, 194, 196, 198};
    constexpr std::array kSolids{150, 152, 154, 156, 158, 160, 162, 164, 168, 180, 186, 430, 514};
    constexpr int kOtherFile = 416;
    const auto is_of = [&](const auto& types) {
      return std::ranges::find(types, entity.TypeNumber()) != types.end();
    };
    if (is_of(kFaces)) return "face";
    if (entity.SubordinateStatus() % 2 == 1) return {};
    if (is_of(kSurfaces)) return "surface";
    if (is_of(kSolids)) return "solid";
    if (entity.TypeNumber() == kOtherFile) return "reference to another file";
    const bool is_read = !entity.IsKind(STANDARD_TYPE(IGESData_UndefinedEntity)) &&
                         !model_->IsErrorEntity(model_->Number(&entity));
    return is_read ? std::string_view() : "entity";
  }

  /// Or of a subfigure of which nothing can be read.
  bool is_instance_of_shape(const Handle(IGESData_IGESEntity) & entity) const {
    const auto instance = Handle(IGESBasic_SingularSubfigure)::DownCast(entity);
    if (instance.IsNull()) return false;
    const Handle(IGESBasic_SubfigureDef) of = instance->Subfigure();
    if (of.IsNull() || of->NbEntities() == 0) return true;
    for (int n = 1; n <= of->NbEntities(); ++n) {
      const Handle(IGESData_IGESEntity) entry = of->AssociatedEntity(n);
      if (!entry.IsNull() && !word_of(*entry).empty()) return true;
    }
    return false;
  }

  void lose(const Handle(Standard_Transient) & entity, std::string_view word) {
    if (!lost_.insert(model_->Number(entity)).second) return;
    words_.push_back(fmt::format("OpenCASCADE makes nothing of {} {}{}, which is left out", word,
                                 label(entity), said_of(entity)));
  }

  Handle(Interface_InterfaceModel) model_;
  Handle(Transfer_TransientProcess) process_;
  std::set<int> lost_;
  std::vector<std::string> words_;
};

}  // namespace

std::vector<std::string> losses_of(const Handle(XSControl_WorkSession) & session) {
  return Losses(session).all();
}

std::function<std::string(const TopoDS_Shape&)> closed_shells_of(
    const Handle(XSControl_WorkSession) & session) {
  const Handle(Interface_InterfaceModel) model = session->Model();
  const auto process = session->TransferReader()->TransientProcess();
  std::map<const void*, std::string> shell_of;  // instances of a part share its faces
  for (int n = 1; n <= model->NbEntities(); ++n) {
    const auto shell = Handle(StepShape_ClosedShell)::DownCast(model->Value(n));
    if (shell.IsNull()) continue;
    const TopoDS_Shape shape = TransferBRep::ShapeResult(process, shell);
    const std::string words =
        fmt::format("closed shell {}", model->StringLabel(shell)->ToCString());
    if (shape.IsNull()) continue;
    for (TopExp_Explorer face(shape, TopAbs_FACE); face.More(); face.Next()) {
      shell_of.emplace(face.Current().TShape().get(), words);
    }
  }
  return [shell_of](const TopoDS_Shape& face) {
    const auto found = shell_of.find(face.TShape().get());
    return found == shell_of.end() ? std::string() : found->second;
  };
}

}  // namespace vdb_offset::cad
