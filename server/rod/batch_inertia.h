#pragma once

/// Inertia and weight of the elements of plain strands (rod.md, S5, S12, Quadrature); only for
/// sources that define MANE_ISA.

#include "rod/batch_step.h"

namespace mane::rod {
namespace MANE_ISA {

// Sums over the combinations of the Gauss points of (1/2 M |velocity + spin x r + J v|^2 - m u.(the
// same)), with mu of S12 for `rotary`. J and r are
// combinations of d0, theta and A whose coefficients are numbers, so that these need to be summed,
// not the matrices (rod.md, B3).
template <typename T, int W>
[[gnu::always_inline]] inline void StrandStep<T, W>::AddInertia(const Constants& step,
                                                                const V& rotary, const V& length,
                                                                const T* state, const Element& e,
                                                                RateCost& rates, CostToGo& left) {
  V s2{}, s3{}, t2{}, t3{};                              // <phi>, <psi>
  V m12{}, m13{}, m22{}, m23{}, m33{};                   // <phi phi>
  V n12{}, n13{}, n22{}, n33{}, n32_23{}, o22{}, o33{};  // <phi psi>, <psi psi>
  // <u>, <phi u>, <psi u>. Weight acts as momentum evenly spread over the length, whose sums are
  // integrals that are known exactly (H7, H8).
  Vec U0 = step.body, U1 = All(0.5) * U0, U2 = e.c3 * U0, U3 = e.c4 * U0;
  Vec V2 = (T(3) * e.c5 - e.c4) * U0, V3 = (T(4) * e.c6 - e.c5) * U0;
  Vec at[kGaussPoints], u[kGaussPoints];
  for (int g = 0; g < kGaussPoints; ++g) at[g] = Rows(state, layout::kVelocities + 3 * g);
  Combine(at, u);
  constexpr T kOuter = T(kGauss.weights[0] / 2);
  const V weight[] = {All(kGauss.weights[1]), All(kOuter), kOuter + rotary};
#pragma GCC unroll 3
  for (int k = 0; k < kGaussPoints; ++k) {
    const V w = weight[k], phi2 = e.phi2[k], phi3 = e.phi3[k], psi2 = e.psi2[k], psi3 = e.psi3[k];
    const V w2 = w * phi2, w3 = w * phi3, x2 = w * psi2, x3 = w * psi3;
    const T s = kNode[k];
    if (k != kDifference) {  // Which has no part in translation.
      const T both = k == kSum ? T(2) : T(1);
      s2 += both * w2, s3 += both * w3, t2 += both * x2, t3 += both * x3;
      U0 += (both * w) * u[k];
    }
    m12 += s * w2, m13 += s * w3, n12 += s * x2, n13 += s * x3;
    m22 += w2 * phi2, m23 += w2 * phi3, m33 += w3 * phi3;
    n22 += w2 * psi2, n33 += w3 * psi3, n32_23 += w3 * psi2 - w2 * psi3;
    o22 += x2 * psi2, o33 += x3 * psi3;
    U1 += (s * w) * u[k];
    U2 += w2 * u[k], U3 += w3 * u[k], V2 += x2 * u[k], V3 += x3 * u[k];
  }
  const Vec d0 = e.R.n0, th = e.th, A = e.A, B = e.B();
  const V tau = e.tau, zeta = e.zeta, beta = zeta - tau * tau;  // beta = |A|^2

  // Momentum: J^T u, u and r x u.
  const V length2 = length * length;
  rates.g += length2 * (Cross(d0, U2) + tau * U3 + Dot(th, U3) * d0 +
                        (Dot(A, V2) + Dot(B, V3) - T(2) * Dot(d0, U3)) * th);
  left.b1 += length * U0;
  left.b2 += length2 * (Cross(d0, U1) + Cross(A, U2) + Cross(B, U3));

  // Inertia. From here on the sums are those of an element of its own length and mass.
  const V I0 = length * step.inertia, I1 = length * I0, I2 = length * I1;
  s2 *= I1, s3 *= I1, t2 *= I1, t3 *= I1;
  const V s1 = T(0.5) * I1,
          m11 = (T(1.0 / 3) + (kNode[kDifference] * kNode[kDifference]) * rotary) * I2;
  m12 *= I2, m13 *= I2, m22 *= I2, m23 *= I2, m33 *= I2;
  n12 *= I2, n13 *= I2, n22 *= I2, n33 *= I2, n32_23 *= I2, o22 *= I2, o33 *= I2;
  const V tau_m23 = tau * m23, tau_m33 = tau * m33, zeta_m33 = zeta * m33;

  // J^T J.
  const V both =
      T(2) * (n22 + (tau * tau + T(2) * beta) * n33) + T(4) * m33 + beta * (o22 + zeta * o33);
  const V diagonal = m22 + tau * tau_m33;
  rates.H.xx += diagonal, rates.H.yy += diagonal, rates.H.zz += diagonal;
  AddTwice(
      rates.H, d0,
      (T(0.5) * (zeta_m33 - m22)) * d0 - (tau * (T(3) * m33 + n22 + zeta * n33)) * th - m23 * A);
  AddTwice(rates.H, th, (T(0.5) * both) * th + (tau * n32_23) * A);

  // J^T.
  const Vec s3th = s3 * th;
  const Vec C = t2 * A + (t3 * tau) * th - (t3 * zeta + T(2) * s3) * d0;
  AddCrossMatrix(rates.Hv1, s2 * d0, s3 * tau);
  AddOuter(rates.Hv1, d0, s3th);
  AddOuter(rates.Hv1, th, C);

  // -J^T [r].
  const V m13_33 = m13 - zeta_m33, twice = T(2) * m23 + n12;
  const Vec w = -tau * (m13_33 * d0 + m23 * A + tau_m33 * th);
  AddCrossMatrix(rates.Hv2, w, m12 - beta * m23);
  AddOuter(rates.Hv2, d0, (T(2) * zeta * m23 - m12) * d0 - tau_m23 * th - m13_33 * A);
  AddOuter(rates.Hv2, A, -m22 * d0);
  AddOuter(
      rates.Hv2, th,
      (twice - beta * n32_23) * th - (tau * (m23 + twice)) * d0 - (T(2) * tau_m33 + tau * n13) * A);

  // The whole element turning and moving as a rigid body.
  left.A11.xx += I0, left.A11.yy += I0, left.A11.zz += I0;
  left.A12 -= CrossMatrix(s1 * d0 + s2 * A + s3 * B);
  Symmetric<V> second{};  // r r^T
  AddTwice(
      second, d0,
      (T(0.5) * (m11 - zeta * (m13 + m13_33))) * d0 + (m12 - zeta * m23) * A + (tau * m13_33) * th);
  AddTwice(second, A, (T(0.5) * m22) * A + tau_m23 * th);
  AddOuter(second, (tau * tau_m33) * th, th);
  AddInertiaOf(left.A22, second);
}

}  // namespace MANE_ISA
}  // namespace mane::rod
