// SPDX-License-Identifier: GPL-3.0-or-later

#include "recorder/sources/devices/camera/lens_calibration.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <map>
#include <optional>
#include <set>

#include "recorder/base/errors.h"
#include "recorder/sources/devices/camera/handle_fit.h"
#include "recorder/sources/devices/camera/marker_sheets.h"
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
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(equations, Eigen::ComputeThinV);
  const Eigen::VectorXd h = svd.matrixV().col(8);
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

Block6 vectorOf(const Pose& pose) {
  const Quat q = pose.orientation.w() < 0.0 ? Quat(-pose.orientation.coeffs()) : pose.orientation;
  const double sine = q.vec().norm();
  Block6 out;
  out << (sine < 1e-12 ? Vec3(2.0 * q.vec()) : Vec3(2.0 * std::atan2(sine, q.w()) / sine * q.vec())), pose.position;
  return out;
}

Pose poseOf(const Block6& v) { return {v.tail<3>(), rotationBy(v.head<3>())}; }

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
  BlockProblem problem;
  problem.shared = Eigen::VectorXd::Zero(8);
  problem.shared << *focal * width, *focal * width, middle, 0.0, 0.0, 0.0, 0.0;
  problem.step = Eigen::VectorXd::Constant(8, 1e-6);
  problem.step.head<4>().setConstant(1e-3);
  for (const Mat3& h : homographies) problem.local.push_back(vectorOf(poseOfHomography(h, *focal)));
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
  out.lens = lensOf(problem.shared, width, height);
  if (!solution.converged || !(out.lens.focal.minCoeff() > 0.1 * width) || !(out.lens.focal.maxCoeff() < 20.0 * width))
    refuseViews(name, "no lens explains the views of the board: keep it flat, and film it sharp");
  out.lens.views = static_cast<int>(views.size());
  out.lens.residual = solution.residual;
  out.lens.coverage = coverageOf(corners, width, height);
  out.lens.focalUncertainty = std::max(solution.uncertainty[0], solution.uncertainty[1]) / out.lens.focal.mean();
  for (std::size_t b = 0; b < views.size(); ++b) {
    out.board.push_back(poseOf(problem.local[b]));
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
  // Poses of the board by each camera alone, with its lens.
  const auto poseBy = [&](const BoardView& view, const CameraLens& lens) {
    const BoardCorners corners = cornersOfView(view, printScale);
    BlockProblem alone;
    alone.shared = Eigen::VectorXd::Zero(1);  // none: without influence
    alone.step = Eigen::VectorXd::Constant(1, 1.0);
    const Mat3 h = homographyOf(corners, lens.centre, lens.width);
    alone.local.push_back(vectorOf(poseOfHomography(h, lens.focal.mean() / lens.width)));
    alone.residual = [&](std::size_t, const Eigen::VectorXd& none, const Block6& local) {
      Eigen::VectorXd out(2 * static_cast<Eigen::Index>(corners.size()) + 1);
      for (std::size_t i = 0; i < corners.size(); ++i)
        out.segment<2>(2 * static_cast<Eigen::Index>(i)) = errorOf(lens, poseOf(local), corners[i]);
      out[out.size() - 1] = none[0];
      return out;
    };
    solveBlocks(alone);
    return poseOf(alone.local.front());
  };
  std::vector<BoardCorners> a, b;
  BlockProblem problem;
  Pose best;
  double least = 1e300;
  std::vector<Pose> board;
  for (std::size_t i = 0; i < first.size(); ++i) {
    a.push_back(cornersOfView(first[i], printScale));
    b.push_back(cornersOfView(second[i], printScale));
    board.push_back(poseBy(first[i], firstLens.lens));
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
  for (std::size_t i = 0; i < first.size(); ++i) {
    const Pose there = poseBy(second[i], secondLens.lens);
    const Quat turn = there.orientation * board[i].orientation.conjugate();
    const Pose pair{there.position - turn * board[i].position, turn};
    double cost = 0.0;
    for (std::size_t v = 0; v < first.size(); ++v) cost += errors(v, pair, board[v]).squaredNorm();
    if (cost < least) {
      least = cost;
      best = pair;
    }
  }
  problem.shared = vectorOf(best);
  problem.step = Eigen::VectorXd::Constant(6, 1e-6);
  for (const Pose& pose : board) problem.local.push_back(vectorOf(pose));
  problem.residual = [&](std::size_t v, const Eigen::VectorXd& shared, const Block6& local) {
    return errors(v, poseOf(Block6(shared)), poseOf(local));
  };
  const BlockSolution solution = solveBlocks(problem);
  if (!solution.converged) refuseViews(name, "no place of the second camera explains what both saw");
  return {poseOf(Block6(problem.shared)), solution.residual, static_cast<int>(first.size())};
}

namespace {

using Matrix6 = Eigen::Matrix<double, 6, 6>;
constexpr int mostIterations = 60;

struct BlockTerms {
  Matrix6 own;
  Eigen::MatrixXd across;  // shared x 6
  Block6 gradient;
};

struct BlockSystem {
  Eigen::MatrixXd shared;
  Eigen::VectorXd gradient;
  std::vector<BlockTerms> block;
};

double costOf(const BlockProblem& p, const Eigen::VectorXd& shared, const std::vector<Block6>& local,
              Eigen::Index& count) {
  double cost = 0.0;
  count = 0;
  for (std::size_t b = 0; b < local.size(); ++b) {
    const Eigen::VectorXd r = p.residual(b, shared, local[b]);
    cost += r.squaredNorm();
    count += r.size();
  }
  return cost;
}

BlockSystem systemOf(const BlockProblem& p) {
  const Eigen::Index n = p.shared.size();
  BlockSystem out{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n), {}};
  for (std::size_t b = 0; b < p.local.size(); ++b) {
    const Eigen::VectorXd r = p.residual(b, p.shared, p.local[b]);
    Eigen::MatrixXd toShared(r.size(), n), toLocal(r.size(), 6);
    for (Eigen::Index i = 0; i < n; ++i) {
      Eigen::VectorXd up = p.shared, down = p.shared;
      up[i] += p.step[i];
      down[i] -= p.step[i];
      toShared.col(i) = (p.residual(b, up, p.local[b]) - p.residual(b, down, p.local[b])) / (2.0 * p.step[i]);
    }
    for (Eigen::Index i = 0; i < 6; ++i) {
      Block6 up = p.local[b], down = p.local[b];
      up[i] += p.localStep;
      down[i] -= p.localStep;
      toLocal.col(i) = (p.residual(b, p.shared, up) - p.residual(b, p.shared, down)) / (2.0 * p.localStep);
    }
    out.shared += toShared.transpose() * toShared;
    out.gradient += toShared.transpose() * r;
    out.block.push_back({toLocal.transpose() * toLocal, toShared.transpose() * toLocal, toLocal.transpose() * r});
  }
  return out;
}

/// Normal matrix of the shared unknowns, and its right side, after the blocks' own are eliminated.
void reduce(const BlockSystem& s, double damping, Eigen::MatrixXd& matrix, Eigen::VectorXd& right) {
  matrix = s.shared;
  matrix.diagonal() += damping * s.shared.diagonal();
  right = -s.gradient;
  for (const BlockTerms& b : s.block) {
    Matrix6 own = b.own;
    own.diagonal() += damping * b.own.diagonal();
    const Matrix6 inverse = own.inverse();
    matrix -= b.across * inverse * b.across.transpose();
    right += b.across * (inverse * b.gradient);
  }
}

}  // namespace

BlockSolution solveBlocks(BlockProblem& problem) {
  Eigen::Index count = 0;
  double cost = costOf(problem, problem.shared, problem.local, count);
  double damping = 1e-3;
  BlockSolution out;
  for (int iteration = 0; iteration < mostIterations && !out.converged && std::isfinite(cost); ++iteration) {
    const BlockSystem system = systemOf(problem);
    for (;;) {
      Eigen::MatrixXd matrix;
      Eigen::VectorXd right;
      reduce(system, damping, matrix, right);
      const Eigen::VectorXd step = matrix.ldlt().solve(right);
      const Eigen::VectorXd shared = problem.shared + step;
      std::vector<Block6> local = problem.local;
      for (std::size_t b = 0; b < local.size(); ++b) {
        const BlockTerms& t = system.block[b];
        Matrix6 own = t.own;
        own.diagonal() += damping * t.own.diagonal();
        local[b] += own.ldlt().solve(Block6(-t.gradient - t.across.transpose() * step));
      }
      Eigen::Index ignored = 0;
      const double next = costOf(problem, shared, local, ignored);
      if (std::isfinite(next) && next <= cost) {
        out.converged = cost - next <= 1e-10 * (1.0 + cost);
        problem.shared = shared;
        problem.local = std::move(local);
        cost = next;
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
  if (!std::isfinite(cost) || count == 0) return {};
  const auto unknowns = problem.shared.size() + 6 * static_cast<Eigen::Index>(problem.local.size());
  out.residual = std::sqrt(2.0 * cost / static_cast<double>(count));  // of points, which have two residuals each
  Eigen::MatrixXd matrix;
  Eigen::VectorXd right;
  reduce(systemOf(problem), 0.0, matrix, right);
  const double variance = cost / static_cast<double>(std::max<Eigen::Index>(1, count - unknowns));
  out.uncertainty = (variance * matrix.inverse().diagonal()).cwiseMax(0.0).cwiseSqrt();
  return out;
}

}  // namespace calot::recorder
