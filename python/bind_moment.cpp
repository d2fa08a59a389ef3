// SPDX-License-Identifier: GPL-3.0-or-later

#include "python/bindings.h"
#include "python/moment.h"

namespace py = pybind11;

namespace calot::python {

namespace {

py::bytes vectorsOf(const std::vector<Vec3>& vectors) {
  static_assert(sizeof(Vec3) == 3 * sizeof(double));
  return bytesOf(vectors);
}

py::tuple poseOf(const Vec3& p, const Quat& q) {
  return py::make_tuple(p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z());
}

py::list surfacesOf(const Moment& moment) {
  py::list out;
  for (const SurfaceView& s : moment.view.surface)
    out.append(py::make_tuple(s.organ, vectorsOf(s.position), vectorsOf(s.rest),
                              bytesOf(s.triangle.data(), s.triangle.size() * sizeof(Index3))));
  return out;
}

py::list instrumentsOf(const Moment& moment) {
  py::list out;
  for (const InstrumentView& i : moment.view.instrument)
    out.append(
        py::make_tuple(static_cast<int>(i.kind), poseOf(i.pose.position, i.pose.orientation), i.jaw, i.touching));
  return out;
}

py::tuple cameraOf(const Moment& moment) {
  const CameraSample& c = moment.view.camera;
  return py::make_tuple(poseOf(c.position, c.orientation), moment.view.verticalFieldOfView);
}

py::list stateOf(const Moment& moment) {
  py::list out;
  for (const recorder::StateField& f : withoutLock([&] { return fieldsOf(moment); })) {
    if (const auto* reals = std::get_if<std::vector<double>>(&f.values)) {
      out.append(py::make_tuple(f.name, "f8", bytesOf(*reals)));
    } else {
      out.append(py::make_tuple(f.name, "u8", bytesOf(std::get<std::vector<std::uint64_t>>(f.values))));
    }
  }
  return out;
}

py::tuple rendered(const Moment& moment, int width, int height, const std::string& quality, bool mask, bool cavity,
                   const std::optional<std::array<double, 7>>& camera, const std::optional<double>& fieldOfView) {
  const gui::Image image = withoutLock([&] {
    return draw(moment, {width, height, quality, mask, cavity, camera, fieldOfView});
  });
  return py::make_tuple(image.width, image.height, bytesOf(image.rgba));
}

}  // namespace

void bindMoment(py::module_& m) {
  py::class_<Moment>(m, "Moment", "A scene after a step.")
      .def_property_readonly("step", [](const Moment& o) { return o.view.step; })
      .def_property_readonly("time", [](const Moment& o) { return o.view.time; })
      .def_property_readonly("surfaces", surfacesOf)
      .def_property_readonly("instruments", instrumentsOf)
      .def_property_readonly("camera", cameraOf)
      .def("state", stateOf)
      .def("render", rendered, "width"_a, "height"_a, "quality"_a, "mask"_a, "cavity"_a, "camera"_a, "field_of_view"_a);
  py::class_<MomentSeeker>(m, "Seeker", "Goes anywhere in a recording.")
      .def(py::init<const std::filesystem::path&>(), "path"_a, py::call_guard<py::gil_scoped_release>())
      .def("seek", &MomentSeeker::seek, "step"_a, py::call_guard<py::gil_scoped_release>());
  m.def("end_rendering", endRendering, "Ends the thread that draws, before the interpreter does.");
}

}  // namespace calot::python
