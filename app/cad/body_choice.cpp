#include "cad/body_choice.hpp"

#include <BRepBndLib.hxx>
#include <BRep_Builder.hxx>
#include <Bnd_Box.hxx>
#include <TopoDS_Compound.hxx>
#include <algorithm>
#include <charconv>
#include <cstdio>

#include "cad/cad_error.hpp"

namespace binpick::cad {
namespace {

constexpr std::size_t kListedMax = 20;

std::string size_text(const TopoDS_Shape& shape) {
  Bnd_Box box;
  BRepBndLib::AddOptimal(shape, box, false, false);
  if (box.IsVoid()) return "empty";
  const gp_XYZ size = box.CornerMax().XYZ() - box.CornerMin().XYZ();
  char text[80];
  std::snprintf(text, sizeof text, "%.4g x %.4g x %.4g mm", size.X(), size.Y(), size.Z());
  return text;
}

[[noreturn]] void refuse(const std::string& fault, const std::vector<Body>& bodies) {
  std::string text = fault + "; choose with --body NAME, --body NUMBER or --body all: ";
  const std::vector<std::string> list = list_of(bodies);
  for (std::size_t i = 0; i < std::min(list.size(), kListedMax); ++i) {
    text += (i == 0 ? "" : ", ") + list[i];
  }
  if (list.size() > kListedMax) {
    text += ", and " + std::to_string(list.size() - kListedMax) + " more";
  }
  throw CadError(text);
}

TopoDS_Shape all_of(const std::vector<Body>& bodies) {
  TopoDS_Compound compound;
  BRep_Builder builder;
  builder.MakeCompound(compound);
  for (const Body& body : bodies) builder.Add(compound, body.shape);
  return compound;
}

}  // namespace

std::vector<std::string> list_of(const std::vector<Body>& bodies) {
  std::vector<std::string> list;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    list.push_back(std::to_string(i + 1) + " '" + bodies[i].name + "' (" +
                   size_text(bodies[i].shape) + ")");
  }
  return list;
}

TopoDS_Shape choose_body(const std::vector<Body>& bodies, const std::string& choice) {
  const std::string count =
      std::to_string(bodies.size()) + (bodies.size() == 1 ? " body" : " bodies");
  if (choice.empty()) {
    if (bodies.size() == 1) return bodies[0].shape;
    refuse("it has " + count, bodies);
  }
  const auto is_called = [&](const Body& body) { return body.name == choice; };
  const auto first = std::find_if(bodies.begin(), bodies.end(), is_called);
  if (first != bodies.end()) {
    const auto is_another = [&](const Body& body) {
      return is_called(body) && !body.shape.IsPartner(first->shape);
    };
    if (std::none_of(first, bodies.end(), is_another)) return first->shape;
    refuse("several different bodies of it are called '" + choice + "'", bodies);
  }
  if (choice == "all") return all_of(bodies);
  std::size_t number = 0;
  const auto [end, error] = std::from_chars(choice.data(), choice.data() + choice.size(), number);
  const bool is_number = error == std::errc() && end == choice.data() + choice.size();
  if (is_number && number >= 1 && number <= bodies.size()) return bodies[number - 1].shape;
  refuse("it has " + count + ", and none is '" + choice + "'", bodies);
}

}  // namespace binpick::cad
