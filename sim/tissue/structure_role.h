// SPDX-License-Identifier: GPL-3.0-or-later
// Role of a tissue in the anatomy of a cholecystectomy. Judgement, performers and pictures identify tissue by its role,
// never by its name or appearance.
#pragma once

#include <cstddef>
#include <cstdint>

namespace calot {

/// Numbers are stored in flat states (sim/scene/flat.h), never in recordings: these hold the scene file.
enum class StructureRole : std::uint8_t {
  other = 0,         ///< plays no part
  liver = 1,         ///< organ
  gallbladder = 2,   ///< organ: the specimen of a cholecystectomy
  cysticDuct = 3,    ///< vessel: from the gallbladder's neck to the bile duct, to be clipped and divided
  cysticArtery = 4,  ///< vessel: supplies the gallbladder, to be clipped and divided
  bileDuct = 5,      ///< vessel: common bile duct or common hepatic duct
  artery = 6,        ///< vessel: any other artery, such as the right hepatic
  triangleFat = 7,   ///< fat in Calot's (hepatocystic) triangle, which hides cystic duct and artery
  cysticPlate = 8    ///< connective tissue between gallbladder and liver: the gallbladder's bed
};

struct StructureRoleName {
  StructureRole role;
  const char* name;  ///< in scene files
};

inline constexpr StructureRoleName structureRoleNames[] = {
    {StructureRole::other, "other"},
    {StructureRole::liver, "liver"},
    {StructureRole::gallbladder, "gallbladder"},
    {StructureRole::cysticDuct, "cystic-duct"},
    {StructureRole::cysticArtery, "cystic-artery"},
    {StructureRole::bileDuct, "bile-duct"},
    {StructureRole::artery, "artery"},
    {StructureRole::triangleFat, "triangle-fat"},
    {StructureRole::cysticPlate, "cystic-plate"},
};

/// Name of a role in scene files.
constexpr const char* nameOf(StructureRole role) {
  for (const StructureRoleName& known : structureRoleNames) {
    if (known.role == role) return known.name;
  }
  return "";
}

/// Cystic duct and cystic artery: what the operation divides.
constexpr bool isCystic(StructureRole role) {
  return role == StructureRole::cysticDuct || role == StructureRole::cysticArtery;
}

/// A vessel that leaks bile where it is open; every other vessel bleeds.
constexpr bool carriesBile(StructureRole role) {
  return role == StructureRole::cysticDuct || role == StructureRole::bileDuct;
}

/// Most structures (organs, vessels and bodies of fat together) of a scene. The key of a contact block has four bits
/// for its structure; masks of structures, as HandResult::touching, have 32. A scene with more is refused at load.
inline constexpr std::size_t maxStructures = 16;

}  // namespace calot
