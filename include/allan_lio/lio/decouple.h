// Copyright 2026 the allan_lio authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <functional>

#include "allan_lio/lio/localizability.h"

namespace allan_lio {

/// Covariance, by the noise of the planes' normals, of the information's product with a direction (rotation in radians,
/// translation in metres).
using CouplingNoise = std::function<PoseMatrix(const PoseVector& direction)>;

/// Rids the directions that a scan does not support of couplings that are noise.
///
/// Over flat ground nothing is known of x. But the normals are noisy, so the direction that comes out is "x with a
/// little pitch", a hundredth of a milliradian a metre, with every scan another. The scan then measures pitch *and*
/// that much of x; pitch is known well, x only to metres after a while, so x is "measured", again and again. Therefore
/// a weak direction is taken for a pure translation (or rotation) unless the information says otherwise by more than
/// the noise of the normals explains (chi^2 of the coupling over its degrees of freedom below 4). A bend that a tunnel
/// really has is far above that and stays.
///
/// `information` and `feigned` as in judge_localizability(). Changes directions and pure, no support.
void decouple(const PoseMatrix& information, const PoseMatrix& feigned, const CouplingNoise& noise,
              Localizability& localizability);

}  // namespace allan_lio
