#pragma once

#include <Standard_Handle.hxx>
#include <TopoDS_Shape.hxx>
#include <functional>
#include <string>
#include <vector>

class XSControl_WorkSession;

namespace vdb_offset::cad {

/// Faces of a STEP or IGES file that OpenCASCADE made nothing of when it transferred them, in
/// words, by the file's own numbers.
std::vector<std::string> losses_of(const Handle(XSControl_WorkSession) & session);

/// Of a STEP file: "closed shell #16" for a face of one, else nothing. Ends with the session.
std::function<std::string(const TopoDS_Shape&)> closed_shells_of(
    const Handle(XSControl_WorkSession) & session);

}  // namespace vdb_offset::cad
