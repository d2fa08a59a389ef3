// SPDX-License-Identifier: GPL-3.0-or-later
// All benchmarks, one function for each file of this folder. Names are paths: the first part is the concern, which
// --benchmark_filter picks by.
#pragma once

namespace calot::bench {

void registerContactStep();    ///< contact/step: whole steps against deformation alone
void registerContactBudget();  ///< contact/budget: time against error over the solver's budgets
void registerContactSolver();  ///< contact/solver: the complementarity problem against dense methods
void registerDetection();      ///< contact/narrow, contact/broad
void registerHaptics();        ///< haptics/tick
void registerCarving();        ///< carving/transform, carving/stroke, carving/growth
void registerFat();            ///< fat/step, fat/stroke
void registerCheckpoints();    ///< checkpoints/motion
void registerMotionFile();     ///< motion/file: a table of motion against bare numbers
void registerCohort();         ///< cohort/import, cohort/study, cohort/list
void registerScenes();         ///< scene/step, scene/operation: whole steps of every scene
void registerSkipping();       ///< skip: what rests is not worked out
void registerRender();         ///< render/cholecystectomy: pictures of the whole operation

void registerPaperCases();  ///< paper: the meshes of the paper's Table 1
void registerMeshGrowth();  ///< mesh: deformation alone, to 200,000 tetrahedra
void registerBoxes();       ///< boxes, precision: deformation alone against Bullet's, time against error
void registerRecordings();  ///< recording: what it costs the loop; replay and seek

void registerAttemptGrowth();  ///< growth/attempt: to 45 minutes of it
void registerPrice();          ///< price, memory: the boxes without the determinism contract; what they take
void registerGradeError();     ///< grade: figures against their limits over meshes, steps and tolerances
void registerRoofline();       ///< roofline: the solver's kernels against what the machine can do

inline void registerAll() {
  registerContactStep();
  registerContactBudget();
  registerContactSolver();
  registerDetection();
  registerHaptics();
  registerCarving();
  registerFat();
  registerCheckpoints();
  registerMotionFile();
  registerCohort();
  registerScenes();
  registerSkipping();
  registerRender();
  registerPaperCases();
  registerMeshGrowth();
  registerBoxes();
  registerRecordings();
  registerAttemptGrowth();
  registerPrice();
  registerGradeError();
  registerRoofline();
}

}  // namespace calot::bench
