// The Scan3d* features of an opened sensor, and the chunks of a frame that replace them.
#pragma once

#include <arv.h>

#include "aravis/features.hpp"
#include "genicam/scan3d.hpp"

namespace binpick::drivers {

// Reads what depth of this format needs: axis C, with points A and B too. Whatever is missing or
// not usable is a SensorError that names it.
Scan3d read_scan3d(const Features& features, const CameraSpec& spec, bool with_points);

// The values of `base` replaced by those chunks that the frame carries; false when a chunk that was
// there at start is missing or its value is not usable. Aravis allocates in this call.
class Scan3dChunks {
 public:
  // Finds out which chunks the sensor knows, and switches them on. Without chunks in the profile
  // nothing is done.
  Scan3dChunks(const Features& features, const CameraSpec& spec);
  ~Scan3dChunks();
  Scan3dChunks(const Scan3dChunks&) = delete;
  Scan3dChunks& operator=(const Scan3dChunks&) = delete;

  bool enabled() const { return parser_ != nullptr; }
  bool apply(ArvBuffer* buffer, Scan3d& scan3d) const;

 private:
  bool read(ArvBuffer* buffer, const char* chunk, double& value) const;

  ArvChunkParser* parser_ = nullptr;
  bool has_focal_length_ = false, has_baseline_ = false, has_principal_point_ = false;
  double shift_px_ = 0, baseline_unit_mm_ = 1;
  bool fixed_intrinsics_ = false;
};

}  // namespace binpick::drivers
