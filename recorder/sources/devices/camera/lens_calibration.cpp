// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/lens_calibration.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/camera/handle_tracker.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
#include "recorder/sources/devices/dense_solvers.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

constexpr std::size_t fewestViews = 3;
constexpr int coverageColumns = 8, coverageRows = 6;
constexpr double behindPenalty = 1e6;  // pixels, of a corner behind the camera

struct BoardCorner {
  Vec3 point;
  Eigen::Vector2d pixel;
};
using BoardCorners = std::vector<BoardCorner>;

BoardCorners cornersOfView(const BoardView& view, double printScale) {
  const std::vector<TagPlace> places = boardTags(printScale);
  BoardCorners out;
  for (const SeenTag& tag : view.tags) {
    const TagPlace& place = places[static_cast<std::size_t>(tag.id - firstBoardTag)];
    for (int k = 0; k < 4; ++k)
      out.push_back({place.corner(k, tagSide * printScale), tag.corner[static_cast<std::size_t>(k)]});
  }
  return out;
}

/// Homography from the board's plane to pixels about the image's middle, in units of its width.
Mat3 homographyOf(const BoardCorners& corners, const Eigen::Vector2d& middle, double unit) {
  constexpr double boardUnit = 0.1;  // m
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(2 * static_cast<Eigen::Index>(corners.size()), 9);
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const auto row = 2 * static_cast<Eigen::Index>(i);
    const Eigen::RowVector3d at(corners[i].point.x() / boardUnit, corners[i].point.y() / boardUnit, 1.0);
    const Eigen::Vector2d seen = (corners[i].pixel - middle) / unit;
    equations.block<1, 3>(row, 0) = at;
    equations.block<1, 3>(row, 6) = -seen.x() * at;
    equations.block<1, 3>(row + 1, 3) = at;
    equations.block<1, 3>(row + 1, 6) = -seen.y() * at;
  }
  const Eigen::VectorXd h = eigenOf(equations.transpose() * equations).vectors.col(0);
  Mat3 out;
  out << h[0], h[1], h[2], h[3], h[4], h[5], h[6], h[7], h[8];
  if (out(2, 2) < 0.0) out = -out;
  out.col(0) /= boardUnit;
  out.col(1) /= boardUnit;
  return out / out.norm();
}

/// Focal length (in units of the width) that makes the homographies' first columns orthogonal and equally long.
std::optional<double> focalOf(const std::vector<Mat3>& homographies) {
  double top = 0.0, bottom = 0.0;
  for (const Mat3& h : homographies) {
    const Mat3 n = h / h.leftCols<2>().norm();
    const auto equation = [&](double a, double b) {  // a w + b = 0
      top -= a * b;
      bottom += a * a;
    };
    equation(n(0, 0) * n(0, 1) + n(1, 0) * n(1, 1), n(2, 0) * n(2, 1));
    equation(n(0, 0) * n(0, 0) + n(1, 0) * n(1, 0) - n(0, 1) * n(0, 1) - n(1, 1) * n(1, 1),
             n(2, 0) * n(2, 0) - n(2, 1) * n(2, 1));
  }
  const double inverseSquare = bottom > 0.0 ? top / bottom : 0.0;
  if (!(inverseSquare > 0.01 && inverseSquare < 25.0)) return std::nullopt;
  return 1.0 / std::sqrt(inverseSquare);
}

Pose poseOfHomography(const Mat3& h, double focal) {
  Mat3 m = h;
  m.topRows<2>() /= focal;
  m /= 0.5 * (m.col(0).norm() + m.col(1).norm());
  if (m(2, 2) < 0.0) m = -m;
  return {m.col(2), quaternionOf(planeRotation(m.col(0), m.col(1)))};
}

using Block6 = Eigen::Matrix<double, 6, 1>;

/// A least-squares problem whose unknowns are a few shared ones and six of each block, as bundle adjustment has them
/// (Triggs et al. 2000, "Bundle adjustment, a modern synthesis").
struct BlockProblem {
  /// Residuals of a block; always as many for one block, and finite where the pose is in front of the camera.
  std::function<Eigen::VectorXd(std::size_t block, const Eigen::VectorXd& shared, const Block6& local)> residual;
  Eigen::VectorXd unknowns;  ///< the shared ones, then those of each block: start, then solution
  Eigen::VectorXd step;      ///< of the shared ones, for differences
  std::size_t blocks = 0;

  [[nodiscard]] Eigen::VectorXd shared() const { return unknowns.head(step.size()); }
  [[nodiscard]] Block6 local(std::size_t b) const {
    return unknowns.segment<6>(step.size() + 6 * static_cast<Eigen::Index>(b));
  }
};

struct BlockSolution {
  bool converged = false;
  double residual = 0.0;        ///< root mean square
  Eigen::VectorXd uncertainty;  ///< standard deviation of each shared unknown
};

struct NormalEquations {
  Eigen::MatrixXd matrix;
  Eigen::VectorXd gradient;
  double cost = 0.0;
  Eigen::Index count = 0;  ///< of residuals
};

double costOf(const BlockProblem& p) {
  double cost = 0.0;
  for (std::size_t b = 0; b < p.blocks; ++b) cost += p.residual(b, p.shared(), p.local(b)).squaredNorm();
  return cost;
}

/// With central differences.
NormalEquations normalEquations(const BlockProblem& p) {
  constexpr double localStep = 1e-6;
  const Eigen::Index n = p.step.size(), all = p.unknowns.size();
  NormalEquations out{Eigen::MatrixXd::Zero(all, all), Eigen::VectorXd::Zero(all)};
  for (std::size_t b = 0; b < p.blocks; ++b) {
    const Eigen::VectorXd r = p.residual(b, p.shared(), p.local(b));
    Eigen::MatrixXd slope(r.size(), n + 6);
    for (Eigen::Index i = 0; i < n + 6; ++i) {
      const double step = i < n ? p.step[i] : localStep;
      const auto moved = [&](double by) {
        Eigen::VectorXd shared = p.shared();
        Block6 local = p.local(b);
        (i < n ? shared[i] : local[i - n]) += by;
        return p.residual(b, shared, local);
      };
      slope.col(i) = (moved(step) - moved(-step)) / (2.0 * step);
    }
    const Eigen::MatrixXd square = slope.transpose() * slope;
    const Eigen::VectorXd gradient = slope.transpose() * r;
    const Eigen::Index at = n + 6 * static_cast<Eigen::Index>(b);
    out.matrix.topLeftCorner(n, n) += square.topLeftCorner(n, n);
    out.matrix.block(0, at, n, 6) = square.topRightCorner(n, 6);
    out.matrix.block(at, 0, 6, n) = square.bottomLeftCorner(6, n);
    out.matrix.block<6, 6>(at, at) = square.bottomRightCorner<6, 6>();
    out.gradient.head(n) += gradient.head(n);
    out.gradient.segment<6>(at) = gradient.tail<6>();
    out.cost += r.squaredNorm();
    out.count += r.size();
  }
  return out;
}

/// Levenberg and Marquardt.
BlockSolution solveBlocks(BlockProblem& problem) {
  constexpr int mostIterations = 60;
  double damping = 1e-3;
  BlockSolution out;
  NormalEquations system = normalEquations(problem);
  for (int iteration = 0; iteration < mostIterations && !out.converged && std::isfinite(system.cost); ++iteration) {
    for (;;) {
      Eigen::MatrixXd matrix = system.matrix;
      matrix.diagonal() *= 1.0 + damping;
      BlockProblem next = problem;
      next.unknowns -= solved(matrix, system.gradient);
      const double cost = costOf(next);
      if (std::isfinite(cost) && cost <= system.cost) {
        out.converged = system.cost - cost <= 1e-10 * (1.0 + system.cost);
        problem.unknowns = next.unknowns;
        system = normalEquations(problem);
        damping = std::max(1e-12, 0.1 * damping);
        break;
      }
      damping *= 10.0;
      if (damping > 1e9) {
        out.converged = true;  // no step is downhill
        break;
      }
    }
  }
  if (!std::isfinite(system.cost) || system.count == 0) return {};
  out.residual = std::sqrt(2.0 * system.cost / static_cast<double>(system.count));  // of points: two residuals each
  const Eigen::Index freedom = std::max<Eigen::Index>(1, system.count - problem.unknowns.size());
  const Eigen::MatrixXd covariance = system.cost / static_cast<double>(freedom) * inverseOf(system.matrix);
  out.uncertainty = covariance.diagonal().head(problem.step.size()).cwiseMax(0.0).cwiseSqrt();
  return out;
}

Block6 vectorOf(const Pose& pose) {
  Block6 out;
  out << rotationVector(pose.orientation), pose.position;
  return out;
}

Pose poseOf(const Block6& v) { return {v.tail<3>(), rotationBy(v.head<3>())}; }

BlockProblem problemOf(const Eigen::VectorXd& shared, const Eigen::VectorXd& step, const std::vector<Pose>& boards) {
  BlockProblem out;
  out.step = step;
  out.blocks = boards.size();
  out.unknowns.resize(step.size() + 6 * static_cast<Eigen::Index>(boards.size()));
  out.unknowns.head(step.size()) = shared;
  for (std::size_t b = 0; b < boards.size(); ++b)
    out.unknowns.segment<6>(step.size() + 6 * static_cast<Eigen::Index>(b)) = vectorOf(boards[b]);
  return out;
}

Eigen::Vector2d errorOf(const CameraLens& lens, const Pose& board, const BoardCorner& corner) {
  const Vec3 at = board.position + board.orientation * corner.point;
  if (!(at.z() > 1e-3)) return {behindPenalty, behindPenalty};
  return projected(lens, at) - corner.pixel;
}

CameraLens lensOf(const Eigen::VectorXd& v, int width, int height) {
  CameraLens lens;
  lens.width = width;
  lens.height = height;
  lens.focal = v.segment<2>(0);
  lens.centre = v.segment<2>(2);
  for (std::size_t i = 0; i < lens.distortion.size(); ++i) lens.distortion[i] = v[4 + static_cast<Eigen::Index>(i)];
  return lens;
}

double coverageOf(const std::vector<BoardCorners>& views, int width, int height) {
  std::set<int> cells;
  for (const BoardCorners& view : views) {
    for (const BoardCorner& c : view) {
      const int column = static_cast<int>(c.pixel.x() * coverageColumns / width);
      const int row = static_cast<int>(c.pixel.y() * coverageRows / height);
      cells.insert(row * coverageColumns + column);
    }
  }
  return static_cast<double>(cells.size()) / (coverageColumns * coverageRows);
}

[[noreturn]] void refuseViews(const std::string& name, const std::string& why) {
  throw Error(ErrorKind::damaged, Where{name}, why);
}

}  // namespace

LensFit fitLens(const std::vector<BoardView>& views, int width, int height, double printScale,
                const std::string& name) {
  if (views.size() < fewestViews) {
    refuseViews(name,
                fmt::format("the board was seen standing still in {} different views, {} or more are needed: move "
                            "it, hold it still for a moment, tilt it, and so on",
                            views.size(), fewestViews));
  }
  const Eigen::Vector2d middle(0.5 * width, 0.5 * height);
  std::vector<BoardCorners> corners;
  std::vector<Mat3> homographies;
  for (const BoardView& view : views) {
    corners.push_back(cornersOfView(view, printScale));
    homographies.push_back(homographyOf(corners.back(), middle, width));
  }
  const std::optional<double> focal = focalOf(homographies);
  if (!focal)
    refuseViews(name, "the views of the board are too alike: tilt it to the left, right, up and down by 30 degrees");
  Eigen::VectorXd start = Eigen::VectorXd::Zero(8), step = Eigen::VectorXd::Constant(8, 1e-6);
  start.head<4>() << *focal * width, *focal * width, middle;
  step.head<4>().setConstant(1e-3);
  std::vector<Pose> boards;
  boards.reserve(homographies.size());
  for (const Mat3& h : homographies) boards.push_back(poseOfHomography(h, *focal));
  BlockProblem problem = problemOf(start, step, boards);
  problem.residual = [&](std::size_t b, const Eigen::VectorXd& shared, const Block6& local) {
    const CameraLens lens = lensOf(shared, width, height);
    const Pose board = poseOf(local);
    Eigen::VectorXd out(2 * static_cast<Eigen::Index>(corners[b].size()));
    for (std::size_t i = 0; i < corners[b].size(); ++i)
      out.segment<2>(2 * static_cast<Eigen::Index>(i)) = errorOf(lens, board, corners[b][i]);
    return out;
  };
  const BlockSolution solution = solveBlocks(problem);
  LensFit out;
  out.lens = lensOf(problem.shared(), width, height);
  if (!solution.converged || !(out.lens.focal.minCoeff() > 0.1 * width) || !(out.lens.focal.maxCoeff() < 20.0 * width))
    refuseViews(name, "no lens explains the views of the board: keep it flat, and film it sharp");
  out.lens.views = static_cast<int>(views.size());
  out.lens.residual = solution.residual;
  out.lens.coverage = coverageOf(corners, width, height);
  out.lens.focalUncertainty = std::max(solution.uncertainty[0], solution.uncertainty[1]) / out.lens.focal.mean();
  for (std::size_t b = 0; b < views.size(); ++b) {
    out.board.push_back(poseOf(problem.local(b)));
    for (const BoardCorner& c : corners[b]) out.residuals.push_back({c.pixel, errorOf(out.lens, out.board.back(), c)});
  }
  return out;
}

PairFit fitPair(const std::vector<BoardView>& first, const LensFit& firstLens, const std::vector<BoardView>& second,
                const LensFit& secondLens, double printScale, const std::string& name) {
  if (first.size() < fewestViews) {
    refuseViews(name, fmt::format("both cameras saw the board standing still at {} moments, {} or more are needed",
                                  first.size(), fewestViews));
  }
  // Pose of the board by one camera alone.
  const auto poseBy = [](BoardCorners corners, const CameraLens& lens) {
    for (BoardCorner& c : corners) c.pixel = undistorted(lens, c.pixel);
    return poseOfHomography(homographyOf(corners, Eigen::Vector2d::Zero(), 1.0), 1.0);
  };
  std::vector<BoardCorners> a, b;
  std::vector<Pose> board;
  for (std::size_t i = 0; i < first.size(); ++i) {
    a.push_back(cornersOfView(first[i], printScale));
    b.push_back(cornersOfView(second[i], printScale));
    board.push_back(poseBy(a.back(), firstLens.lens));
  }
  const auto errors = [&](std::size_t v, const Pose& pair, const Pose& at) {
    Eigen::VectorXd out(2 * static_cast<Eigen::Index>(a[v].size() + b[v].size()));
    Eigen::Index row = 0;
    for (const BoardCorner& c : a[v]) {
      out.segment<2>(row) = errorOf(firstLens.lens, at, c);
      row += 2;
    }
    const Pose inSecond{pair.position + pair.orientation * at.position, pair.orientation * at.orientation};
    for (const BoardCorner& c : b[v]) {
      out.segment<2>(row) = errorOf(secondLens.lens, inSecond, c);
      row += 2;
    }
    return out;
  };
  // The view whose relative pose explains the others best begins.
  Pose best;
  double least = 1e300;
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Pose there = poseBy(b[i], secondLens.lens);
    const Quat turn = there.orientation * board[i].orientation.conjugate();
    const Pose pair{there.position - turn * board[i].position, turn};
    double cost = 0.0;
    for (std::size_t v = 0; v < first.size(); ++v) cost += errors(v, pair, board[v]).squaredNorm();
    if (cost < least) {
      least = cost;
      best = pair;
    }
  }
  BlockProblem problem = problemOf(vectorOf(best), Eigen::VectorXd::Constant(6, 1e-6), board);
  problem.residual = [&](std::size_t v, const Eigen::VectorXd& shared, const Block6& local) {
    return errors(v, poseOf(Block6(shared)), poseOf(local));
  };
  const BlockSolution solution = solveBlocks(problem);
  if (!solution.converged) refuseViews(name, "no place of the second camera explains what both saw");
  return {poseOf(Block6(problem.shared())), solution.residual, static_cast<int>(first.size())};
}

}  // namespace calot::recorder
