// SPDX-License-Identifier: GPL-3.0-or-later
// Traction and separation of connective tissue per unit area: linear up to the strength, then softening linearly until
// the fracture energy is used up (bilinear cohesive law; Camanho, Davila and de Moura 2003, "Numerical simulation of
// mixed-mode progressive delamination in composite materials", with one mode).
//
//   t(w) = (1 - d) K w  for w > 0,   t(w) = K w  for w <= 0,
//   d(w_max) = w_f (w_max - w_0) / (w_max (w_f - w_0))  for w_0 < w_max < w_f,   0 below, 1 above,
//   w_0 = sigma / K,   w_f = 2 G_c / sigma.
//
// w is the separation, w_max the largest so far: damage d never falls, unloading returns along the secant to the
// origin, and compression is that of intact tissue. Up to w_f, opening takes the fracture energy G_c.
#pragma once

namespace calot {

struct CohesiveLaw {
  double stiffness = 0.0;       ///< K (N/m^3)
  double strength = 0.0;        ///< sigma (Pa)
  double fractureEnergy = 0.0;  ///< G_c (J/m^2)

  /// Energy stored where softening begins, the least fracture energy (J/m^2).
  [[nodiscard]] double minFractureEnergy() const { return 0.5 * strength * strength / stiffness; }
  /// w_0 (m)
  [[nodiscard]] double peakSeparation() const { return strength / stiffness; }
  /// w_f (m)
  [[nodiscard]] double finalSeparation() const { return 2.0 * fractureEnergy / strength; }

  /// d for the largest separation so far (m).
  /// @pre fractureEnergy >= minFractureEnergy(); where both are equal, the law is brittle.
  [[nodiscard]] double damageAt(double largest) const {
    const double peak = peakSeparation();
    const double last = finalSeparation();
    if (!(largest < last)) return 1.0;
    if (largest <= peak) return 0.0;
    return last * (largest - peak) / (largest * (last - peak));
  }

  /// Secant stiffness at a separation (N/m^3).
  [[nodiscard]] double secant(double separation, double damage) const {
    return separation > 0.0 ? (1.0 - damage) * stiffness : stiffness;
  }

  /// Energy that reaching a damage has dissipated (J/m^2): the work of opening to w_max less what is stored there,
  /// sigma d w_max / 2, from 0 to G_c.
  [[nodiscard]] double dissipated(double damage) const {
    const double peak = peakSeparation();
    const double last = finalSeparation();
    const double largest = last * peak / (last - damage * (last - peak));
    return 0.5 * strength * damage * largest;
  }
};

}  // namespace calot
