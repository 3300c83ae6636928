#include "cad/solid_file.hpp"

#include <BRepBuilderAPI_Sewing.hxx>
#include <BRep_Builder.hxx>
#include <IGESCAFControl_Reader.hxx>
#include <STEPCAFControl_Reader.hxx>
#include <TDF_LabelSequence.hxx>
#include <TDataStd_Name.hxx>
#include <TDocStd_Document.hxx>
#include <TopExp_Explorer.hxx>
#include <TopoDS_Compound.hxx>
#include <XCAFApp_Application.hxx>
#include <XCAFDoc_DocumentTool.hxx>
#include <XCAFDoc_ShapeTool.hxx>
#include <algorithm>
#include <cctype>

#include "cad/cad_error.hpp"

namespace binpick::cad {
namespace {

constexpr std::size_t kBodiesMax = 10'000;
constexpr int kDepthMax = 100;
constexpr double kSewing_mm = 0.01;  // surfaces that end so close to each other meet

bool is_iges(const std::string& path) {
  std::string extension = path.substr(std::min(path.find_last_of("./"), path.size()));
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".igs" || extension == ".iges";
}

template <class Reader>
void read_into(Handle(TDocStd_Document) & document, const std::string& path, const char* format) {
  Reader reader;
  reader.SetNameMode(true);
  if (reader.ReadFile(path.c_str()) != IFSelect_RetDone) {
    throw CadError(std::string("it is not a ") + format + " file, or is damaged");
  }
  if (!reader.Transfer(document)) {
    throw CadError(std::string("there is no shape in it that can be read as ") + format);
  }
}

std::string name_of(const TDF_Label& label) {
  Handle(TDataStd_Name) attribute;
  if (!label.FindAttribute(TDataStd_Name::GetID(), attribute)) return "";
  const TCollection_ExtendedString& text = attribute->Get();
  std::string name(static_cast<std::size_t>(text.LengthOfCString()) + 1, '\0');
  Standard_PCharacter begin = name.data();
  name.resize(static_cast<std::size_t>(text.ToUTF8CString(begin)));
  return name;
}

// Goes through the assemblies of a file.
class BodyCollector {
 public:
  explicit BodyCollector(const Handle(TDocStd_Document) & document)
      : shapes_(XCAFDoc_DocumentTool::ShapeTool(document->Main())) {
    builder_.MakeCompound(surfaces_);
    TDF_LabelSequence roots;
    shapes_->GetFreeShapes(roots);
    for (const TDF_Label& root : roots) add(root, TopLoc_Location(), 0);
  }

  std::vector<Body> take() {
    if (bodies_.empty() && has_surfaces_) bodies_.push_back(sewn());
    return std::move(bodies_);
  }

 private:
  void add(const TDF_Label& label, const TopLoc_Location& place, int depth) {
    if (depth > kDepthMax) throw CadError("its assemblies are nested too deeply");
    if (!XCAFDoc_ShapeTool::IsAssembly(label)) return add_shape(label, place);
    TDF_LabelSequence components;
    XCAFDoc_ShapeTool::GetComponents(label, components);
    for (const TDF_Label& component : components) {
      TDF_Label product;
      if (!XCAFDoc_ShapeTool::GetReferredShape(component, product)) continue;
      add(product, place * XCAFDoc_ShapeTool::GetLocation(component), depth + 1);
    }
  }

  void add_shape(const TDF_Label& label, const TopLoc_Location& place) {
    const TopoDS_Shape shape = XCAFDoc_ShapeTool::GetShape(label);
    if (shape.IsNull()) return;
    for (TopExp_Explorer solid(shape, TopAbs_SOLID); solid.More(); solid.Next()) {
      if (bodies_.size() == kBodiesMax) {
        throw CadError("it has more than " + std::to_string(kBodiesMax) + " bodies");
      }
      TDF_Label own;
      const bool is_named = shapes_->FindSubShape(label, solid.Current(), own);
      std::string name = is_named ? name_of(own) : "";
      if (name.empty()) name = name_of(label);
      bodies_.push_back({name, solid.Current().Moved(place)});
    }
    for (TopExp_Explorer face(shape, TopAbs_FACE, TopAbs_SOLID); face.More(); face.Next()) {
      builder_.Add(surfaces_, face.Current().Moved(place));
      has_surfaces_ = true;
    }
  }

  Body sewn() const {
    BRepBuilderAPI_Sewing sewing(kSewing_mm);
    sewing.Add(surfaces_);
    sewing.Perform();
    return {"surfaces", sewing.SewedShape()};
  }

  Handle(XCAFDoc_ShapeTool) shapes_;
  BRep_Builder builder_;
  TopoDS_Compound surfaces_;  // outside of any solid
  bool has_surfaces_ = false;
  std::vector<Body> bodies_;
};

}  // namespace

std::vector<Body> read_bodies(const std::string& path) {
  Handle(TDocStd_Document) document;
  XCAFApp_Application::GetApplication()->NewDocument("BinXCAF", document);
  if (is_iges(path)) {
    read_into<IGESCAFControl_Reader>(document, path, "IGES");
  } else {
    read_into<STEPCAFControl_Reader>(document, path, "STEP");
  }
  std::vector<Body> bodies = BodyCollector(document).take();
  if (bodies.empty()) throw CadError("there are neither solids nor surfaces in it");
  return bodies;
}

}  // namespace binpick::cad
