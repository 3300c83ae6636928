// A part's contour at a pose, and the image edges beside it.
#pragma once

#include "pose/scene.hpp"

namespace binpick {

struct ContourMatches {
  simd::ContourPlaces places;
  simd::ContourEdges edges;
  int count = 0, outline_count = 0;  // the outline comes first, then creases
};

// Where the contour of a viewpoint projects to. What is nearer than hidden_mm before a point hides
// it; 0 where there is no depth to tell.
void place_contour(const ObjectModel& model, const Viewpoint& view, const Scene& scene,
                   const Pose& T_cam_centre, int range_px, double hidden_mm, ContourMatches& out);

// The intensity edge nearest to each visible place, up to range_px to either side.
void match_edges(const Scene& scene, int range_px, ContourMatches& matches);

// Drops the edges whose direction is not the contour's (more than about 30 degrees between them).
// Without depth nothing else tells them apart.
void keep_directed_edges(const Scene& scene, ContourMatches& matches);

// Edges are told apart by eight directions, as bits (simd/gradient_bit.hpp): that of an edge across
// a unit normal, and its two neighbours.
unsigned edge_directions_near(float normal_u, float normal_v);

}  // namespace binpick
