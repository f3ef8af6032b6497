// A recorded human motion, as its file holds it.
//
// CSV, one header line: t_s,x_m,y_m,z_m[,qw,qx,qy,qz][,fx_n,fy_n,fz_n]. Time must increase from row
// to row, but the step may vary and rows may be missing. Quaternions must be unit to 1 %; their
// sign may flip. Forces are checked and not kept.
#pragma once

#include <string>
#include <vector>

#include "common/geometry.hpp"

namespace farhand {

struct Recording {
  std::vector<double> t;  // [s], from 0
  std::vector<Vec3> p;    // [m], in the source's axes
  std::vector<Quat> q;    // unit, continuous in sign; empty: the file has no orientation
};

constexpr double kLongestRecording = 3600;          // [s]
constexpr std::size_t kLargestRecording = 1 << 28;  // bytes of the file

// Throws std::runtime_error "file:line: what is wrong; what would be right" on anything that is not
// this format: another header, ragged rows, text or non-finite numbers, time that does not
// increase, fewer than two rows, or a file beyond the limits above.
Recording read_recording(const std::string& file);

}  // namespace farhand
